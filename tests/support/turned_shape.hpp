// Shapes for tests: a machine's with everything turned by one coordinate more.
#pragma once

#include "services/model/evaluate.hpp"

namespace gyrotwin {

/// The last coordinate turns all that stands in the world about one of its axes.
constexpr model::Shape turned_shape(const model::Shape& shape, model::Axis axis) {
  model::Shape turned;
  for (const model::Shape::Joint& joint : shape.bodies) {
    model::ShortList<model::Rotation, 4> rotations;
    if (joint.orientation_parent == model::kGround) rotations.add({axis, shape.coordinates});
    for (const model::Rotation& r : joint.rotations) rotations.add(r);
    turned.hang(joint.position_parent, joint.orientation_parent, rotations);
    turned.pivot_along(joint.pivot).cm_along(joint.cm);
    if (joint.has_rotor) turned.with_rotor();
  }
  turned.gimbals = shape.gimbals;
  return turned;
}

/// A machine's tree with that coordinate. @tparam shape the machine's
template <model::Shape shape, model::Axis axis>
model::Tree turned_tree(const model::Tree& tree) {
  return model::make_tree<turned_shape(shape, axis)>(tree.bodies(), tree.gimbals());
}

}  // namespace gyrotwin
