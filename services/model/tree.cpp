#include "services/model/tree.hpp"

#include <stdexcept>
#include <string>

namespace gyrotwin::model {

Tree::Tree(const Shape& shape, const AllEquations& equations, std::vector<Body> bodies,
           std::vector<Gimbal> gimbals)
    : shape_(shape),
      equations_(equations),
      bodies_(std::move(bodies)),
      gimbals_(std::move(gimbals)) {
  if (std::ssize(bodies_) != shape_.bodies.size || std::ssize(gimbals_) != shape_.gimbals.size) {
    throw std::invalid_argument("tree: its shape has other numbers of bodies and gimbals");
  }
  const auto take_rotor = [this](int index, double inertia) {
    if (index < 0 || index >= kMaxRotors) throw std::invalid_argument("tree: no such rotor");
    rotor_inertia_[static_cast<std::size_t>(index)] = inertia;
  };
  for (int b = 0; b < shape_.bodies.size; ++b) {
    const Body& body = bodies_[b];
    mass_[b] = body.mass;
    moments_[b] = moments_of(body.mass, body.cm, body.inertia);
    if (shape_.bodies[b].has_rotor) {
      take_rotor(body.rotor_index, body.rotor.norm());
    } else if (body.rotor_index >= 0 || !body.rotor.isZero(0)) {
      throw std::invalid_argument("tree: body " + std::to_string(b) +
                                  " has a rotor that its shape has not: with_rotor()");
    }
    const auto off = [](const Eigen::Vector3d& x, Axes axes) {
      for (int i = 0; i < 3; ++i) {
        if (x[i] != 0.0 && !(axes >> i & 1)) return true;
      }
      return false;
    };
    if (off(body.pivot, shape_.bodies[b].pivot)) {
      throw std::invalid_argument("tree: body " + std::to_string(b) +
                                  " has its pivot off its shape's axes: pivot_along()");
    }
    if (off(body.cm, shape_.bodies[b].cm)) {
      throw std::invalid_argument("tree: body " + std::to_string(b) +
                                  " has its centre of mass off its shape's axes: cm_along()");
    }
  }
  for (int g = 0; g < shape_.gimbals.size; ++g) {
    const int b = shape_.gimbals[g].carrier;
    const Gimbal& gimbal = gimbals_[g];
    mass_[b] += gimbal.mass();
    moments_[b].add(gimbal.terms().fixed);
    for (const Gyro& gyro : gimbal.gyros()) take_rotor(gyro.rotor_index, gyro.rotor_inertia);
    if (!gimbal.are(shape_.gimbals[g].gyros)) {
      throw std::invalid_argument("tree: the gyros of gimbal " + std::to_string(g) +
                                  " do not lie as its shape says: gimbal()");
    }
  }
}

}  // namespace gyrotwin::model
