// A mechanism in MuJoCo 2.2.2.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <vector>

#include "tests/bench/plant/forces.hpp"
#include "tests/bench/plant/peer.hpp"

namespace gyrotwin::bench {

enum class Gears { kConstraints, kProjection };

/// The mechanism as MJCF.
struct MjcfOptions {
  Gears gears = Gears::kConstraints;
  double timestep = 1e-3;         ///< [s]
  double constraint_time = 2e-3;  ///< time constant of the gears' springs [s]
};
std::string mjcf_of(const Mechanism& mechanism, const MjcfOptions& options);

/// A model and its data, with the mechanism's forces as MuJoCo's passive ones.
class MujocoMachine {
 public:
  /// @throws Error when MuJoCo refuses the model
  MujocoMachine(const Mechanism& mechanism, const MjcfOptions& options);

  const Mechanism& mechanism() const { return mechanism_; }
  const mjData& data() const { return *data_; }

  /// Forgets everything, what the constraints' solver starts from included.
  void reset() { mj_resetData(model_.get(), data_.get()); }
  /// All hinges from the coordinates.
  void place(const Own& own);
  /// c, from the hinges that lead.
  model::Coordinates coordinates(const mjtNum* per_hinge) const;

  /// What acts from here on; both outlive their use.
  void act_by(const model::RotorSpeeds& rotor_speed, const model::Input& input) {
    rotor_speed_ = &rotor_speed;
    input_ = &input;
  }

  /// mj_forward() and mj_step(), with this machine's forces.
  void forward();
  void step();
  /// c'' by the gears' projection.
  model::Coordinates projected();

 private:
  struct DeleteModel {
    void operator()(mjModel* m) const { mj_deleteModel(m); }
  };
  struct DeleteData {
    void operator()(mjData* d) const { mj_deleteData(d); }
  };
  static void passive(const mjModel* m, mjData* d);
  /// Wrenches of all links, as forces on the hinges.
  void add_wrenches(const mjData& d, mjtNum* on_hinges);

  Mechanism mechanism_;
  Reduction reduction_;
  const model::RotorSpeeds* rotor_speed_ = nullptr;
  const model::Input* input_ = nullptr;
  std::vector<int> leader_;  ///< hinge whose angle is the coordinate
  std::unique_ptr<mjModel, DeleteModel> model_;
  std::unique_ptr<mjData, DeleteData> data_;
};

}  // namespace gyrotwin::bench
