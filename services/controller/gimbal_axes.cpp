#include "services/controller/gimbal_axes.hpp"

#include <algorithm>

namespace gyrotwin {

GimbalAxes::GimbalAxes(const model::GimballedParameters& p) {
  const auto [A, J, U, H, cth, cq] = model::reduce(p);
  F_ << 0.0, 1.0, 0.0, 0.0,         //
      U / A, -cth / A, 0.0, H / A,  //
      0.0, 0.0, 0.0, 1.0,           //
      0.0, -H / J, 0.0, -cq / J;
  B_ << 0.0, 0.0, 0.0, 1.0 / J;

  const model::Machine machine = model::build(p);
  const auto& gimbals = machine.layout.gimbals;
  for (const model::Drive& drive : machine.drives) {
    const auto gyro = std::find_if(gimbals.begin(), gimbals.end(), [&](const auto& gimbal) {
      return gimbal.coordinate == drive.coordinate;
    });
    const bool opposed = p.arrangement == model::Arrangement::kSingle || count_ == 1;
    axes_[count_] = {count_, static_cast<int>(gyro - gimbals.begin()), gyro->coefficient,
                     opposed ? -1.0 : 1.0};
    ++count_;
  }
}

}  // namespace gyrotwin
