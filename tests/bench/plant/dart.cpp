// A mechanism in DART 6.12. Its gears (mimic joints) live in the impulses of a time step, so where
// there are gears they are projected from its inverse dynamics; without, forward dynamics is asked
// for.
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/EulerJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/UniversalJoint.hpp>
#include <vector>

#include "tests/bench/plant/forces.hpp"
#include "tests/bench/plant/peer.hpp"

namespace gyrotwin::bench {

using dart::dynamics::BodyNode;
using Eigen::Vector3d;

namespace {

constexpr double kNothing = 1e-12;  // [kg], [kg m^2]

class Dart : public Peer {
 public:
  explicit Dart(const Rig& rig)
      : mechanism_(mechanism_of(rig)),
        reduction_(mechanism_),
        geared_(reduction_.hinges() > mechanism_.coordinates),
        skeleton_(dart::dynamics::Skeleton::create("machine")) {
    skeleton_->setGravity(Vector3d(0.0, 0.0, -model::kGravity));
    for (const Link& link : mechanism_.links) add(link);
    for (int c = 0; c < mechanism_.coordinates; ++c) {
      units_.emplace_back(reduction_.hinges());
      reduction_.spread(model::Coordinates::Unit(c), units_.back().data());
    }
  }

  std::string name() const override { return "DART"; }

  void load(const std::vector<Sample>& samples) override {
    samples_.assign(samples.begin(), samples.end());
    own_.clear();
    angles_.clear();
    rates_.clear();
    for (const Sample& sample : samples) {
      own_.push_back(to_own(mechanism_, sample.state));
      angles_.emplace_back(reduction_.hinges());
      rates_.emplace_back(reduction_.hinges());
      reduction_.spread(own_.back().c, angles_.back().data());
      reduction_.spread(own_.back().rate, rates_.back().data());
    }
  }

  void evaluate(std::size_t i) override {
    at_ = i;
    skeleton_->setPositions(angles_[i]);
    skeleton_->setVelocities(rates_[i]);
    add_wrenches(samples_[i]);
    found_ = geared_ ? projected(i) : forward(i);
  }

  model::Coordinates acceleration() const override {
    return from_own(mechanism_, samples_[at_].state, found_);
  }

 private:
  void add(const Link& link) {
    BodyNode* parent = link.parent < 0 ? nullptr : bodies_[static_cast<std::size_t>(link.parent)];
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
    place.translation() = link.position;
    place.linear() = link.orientation;
    const auto& hinges = link.hinges;
    BodyNode* body = nullptr;
    if (hinges.size() == 1) {
      body = add_revolute(parent, hinges[0], place);
    } else if (hinges.size() == 2) {
      body = add_universal(parent, hinges[0], hinges[1], place);
    } else if (mechanism_.free_disc) {
      dart::dynamics::EulerJoint::Properties joint;
      joint.mName = next_name();
      joint.mAxisOrder = dart::dynamics::EulerJoint::AxisOrder::XYZ;
      joint.mT_ParentBodyToJoint = place;
      body =
          skeleton_
              ->createJointAndBodyNodePair<dart::dynamics::EulerJoint>(parent, joint, next_body())
              .second;
    } else {
      BodyNode* carrier = add_universal(parent, hinges[0], hinges[1], place);
      // DART has no body without mass.
      carrier->setInertia(dart::dynamics::Inertia(kNothing, Vector3d::Zero(),
                                                  kNothing * Eigen::Matrix3d::Identity()));
      body = add_revolute(carrier, hinges[2], Eigen::Isometry3d::Identity());
    }
    body->setInertia(
        dart::dynamics::Inertia(link.mass, link.cm, Eigen::Matrix3d(link.inertia.asDiagonal())));
    bodies_.push_back(body);
  }

  /// DART says so at length when names repeat.
  std::string next_name() const { return std::to_string(skeleton_->getNumBodyNodes()); }
  BodyNode::Properties next_body() const {
    return BodyNode::Properties(BodyNode::AspectProperties(next_name()));
  }

  BodyNode* add_revolute(BodyNode* parent, const Hinge& hinge, const Eigen::Isometry3d& place) {
    dart::dynamics::RevoluteJoint::Properties joint;
    joint.mName = next_name();
    joint.mAxis = hinge.axis;
    joint.mT_ParentBodyToJoint = place;
    return skeleton_
        ->createJointAndBodyNodePair<dart::dynamics::RevoluteJoint>(parent, joint, next_body())
        .second;
  }

  BodyNode* add_universal(BodyNode* parent, const Hinge& first, const Hinge& second,
                          const Eigen::Isometry3d& place) {
    dart::dynamics::UniversalJoint::Properties joint;
    joint.mName = next_name();
    joint.mAxis = {first.axis, second.axis};
    joint.mT_ParentBodyToJoint = place;
    return skeleton_
        ->createJointAndBodyNodePair<dart::dynamics::UniversalJoint>(parent, joint, next_body())
        .second;
  }

  void add_wrenches(const Sample& sample) {
    Motions motion;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Eigen::Isometry3d& place = bodies_[b]->getWorldTransform();
      const Eigen::Vector6d& twist = bodies_[b]->getSpatialVelocity();  // in the body's axes
      motion[b] = {place.linear(), place.translation(), place.linear() * twist.tail<3>(),
                   place.linear() * twist.head<3>()};
    }
    Wrenches wrench;
    act(mechanism_, motion, sample.state.rotor_speed, sample.input, wrench);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      bodies_[b]->setExtForce(wrench[b].force);
      bodies_[b]->addExtTorque(wrench[b].moment);
    }
  }

  model::Coordinates forward(std::size_t i) {
    for (int h = 0; h < reduction_.hinges(); ++h) {
      skeleton_->setForce(static_cast<std::size_t>(h), 0.0);
    }
    act_on_coordinates(mechanism_, own_[i].c.data(), own_[i].rate.data(), samples_[i].input,
                       [this](int c, double f) {
                         const auto hinge = static_cast<std::size_t>(c);
                         skeleton_->setForce(hinge, skeleton_->getForce(hinge) + f);
                       });
    skeleton_->computeForwardDynamics();
    model::Coordinates c = model::Coordinates::Zero();
    for (int h = 0; h < reduction_.hinges(); ++h) {
      c[h] = skeleton_->getAcceleration(static_cast<std::size_t>(h));
    }
    return c;
  }

  model::Coordinates projected(std::size_t i) {
    const int n = reduction_.hinges();
    // What the hinges would have to exert to be without acceleration, and for a unit of each
    // coordinate's: cheaper than the mass matrix of all hinges.
    skeleton_->setAccelerations(still_);
    skeleton_->computeInverseDynamics(true);
    const Eigen::VectorXd bias = skeleton_->getForces();
    reduction_.clear();
    for (int r = 0; r < n; ++r) reduction_.add_force(r, -bias[r]);
    for (int c = 0; c < mechanism_.coordinates; ++c) {
      skeleton_->setAccelerations(units_[static_cast<std::size_t>(c)]);
      skeleton_->computeInverseDynamics(true);
      for (int r = 0; r < n; ++r) {
        const double force = skeleton_->getForce(static_cast<std::size_t>(r));
        reduction_.add_column(r, c, force - bias[r]);
      }
    }
    act_on_coordinates(mechanism_, own_[i].c.data(), own_[i].rate.data(), samples_[i].input,
                       [this](int c, double f) { reduction_.add_coordinate_force(c, f); });
    return reduction_.solve();
  }

  Mechanism mechanism_;
  Reduction reduction_;
  bool geared_;
  dart::dynamics::SkeletonPtr skeleton_;
  std::vector<BodyNode*> bodies_;       ///< of the links
  std::vector<Eigen::VectorXd> units_;  ///< hinges' accelerations per one of a coordinate
  Eigen::VectorXd still_ = Eigen::VectorXd::Zero(reduction_.hinges());
  std::vector<Sample> samples_;
  std::vector<Own> own_;
  std::vector<Eigen::VectorXd> angles_, rates_;  ///< of the hinges, per sample
  std::size_t at_ = 0;
  model::Coordinates found_;
};

}  // namespace

std::unique_ptr<Peer> dart_peer(const Rig& rig) { return std::make_unique<Dart>(rig); }

}  // namespace gyrotwin::bench
