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
  for (int b = 0; b < shape_.bodies.size; ++b) {
    const Body& body = bodies_[b];
    mass_[b] = body.mass;
    moments_[b] = moments_of(body.mass, body.cm, body.inertia);
    if (shape_.bodies[b].has_rotor) {
      if (body.rotor_index < 0 || body.rotor_index >= kMaxRotors) {
        throw std::invalid_argument("tree: no such rotor");
      }
      rotor_inertia_[body.rotor_index] = body.rotor.norm();
    } else if (body.rotor_index >= 0 || !body.rotor.isZero(0)) {
      throw std::invalid_argument("tree: body " + std::to_string(b) +
                                  " has a rotor that its shape has not: with_rotor()");
    }
    if (!fits(body.pivot, shape_.bodies[b].pivot)) {
      throw std::invalid_argument("tree: body " + std::to_string(b) +
                                  " has its pivot off its shape's axes: pivot_along()");
    }
    if (!fits(body.cm, shape_.bodies[b].cm)) {
      throw std::invalid_argument("tree: body " + std::to_string(b) +
                                  " has its centre of mass off its shape's axes: cm_along()");
    }
  }
  for (int g = 0; g < shape_.gimbals.size; ++g) {
    const int b = shape_.gimbals[g].carrier;
    const Gimbal& gimbal = gimbals_[g];
    mass_[b] += gimbal.mass();
    moments_[b].add(gimbal.terms().fixed);
    for (const Gyro& gyro : gimbal.gyros()) rotor_inertia_[gyro.rotor_index] = gyro.rotor_inertia;
    if (!gimbal.lie_as(shape_.gimbals[g].gyros)) {
      throw std::invalid_argument("tree: the gyros of gimbal " + std::to_string(g) +
                                  " do not lie as its shape says: gimbal()");
    }
  }
}

}  // namespace gyrotwin::model
