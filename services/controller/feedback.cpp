#include "services/controller/feedback.hpp"

#include <complex>
#include <cstdio>

#include "services/controller/riccati.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

std::string number(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

double inverse_square(double largest) { return 1.0 / (largest * largest); }

}  // namespace

std::string listed(const Eigen::VectorXcd& poles) {
  std::string text;
  for (const std::complex<double>& pole : poles) {
    if (pole.imag() > 0.0) continue;  // the lower of the pair has said it
    text += (text.empty() ? "" : ", ") + number("%.4g", pole.real());
    if (pole.imag() < 0.0) text += "+-" + number("%.4g", -pole.imag()) + "i";
  }
  return text + " 1/s";
}

std::string Feedback::describe() const {
  std::string text = "K = (";
  for (Eigen::Index i = 0; i < K.size(); ++i) text += (i ? ", " : "") + number("%.6g", K[i]);
  return text + "), closed-loop poles " + listed(poles);
}

Feedback feedback_for(const Rig& rig, const Eigen::MatrixXd& F, const Eigen::VectorXd& B,
                      const std::vector<Weight>& weights) {
  const auto& controller = rig.controller;
  const Eigen::Index n = F.rows();
  if (!controller.gain.empty()) {
    if (std::ssize(controller.gain) != n) {
      throw Error(rig.file.string() + ": `[controller] gain` has " +
                  std::to_string(controller.gain.size()) + " numbers, law " +
                  std::string(name_of(controller.law)) + " takes " + std::to_string(n) +
                  "; give that many, or remove the key to have them computed");
    }
    const Eigen::RowVectorXd K = Eigen::Map<const Eigen::RowVectorXd>(controller.gain.data(), n);
    return {K, poles(F - B * K)};
  }

  Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(n, n);
  for (const Weight& w : weights) {
    Q(w.state, w.state) = inverse_square(w.largest.value());
  }
  const double R = inverse_square(controller.torque_max.value());
  const Regulator regulator = solve_riccati(F, B, Q, R);
  return {regulator.K, regulator.poles};
}

}  // namespace gyrotwin
