// A mechanism in Simbody 3.7. Its gears are projected from its mass matrix and inverse dynamics,
// which takes a seventh of the time that coordinate couplers take.
#include <Simbody.h>

#include <vector>

#include "tests/bench/plant/forces.hpp"
#include "tests/bench/plant/peer.hpp"

namespace gyrotwin::bench {

using SimTK::MobilizedBody;
using SimTK::Rotation;
using SimTK::SpatialVec;
using SimTK::Transform;
using SimTK::Vec3;

namespace {

Vec3 vec(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d vec(const Vec3& v) { return {v[0], v[1], v[2]}; }

/// The mobility of a hinge; `sense` -1 where its joint is mounted the other way round.
struct Mobility {
  MobilizedBody body;
  int index;
  double sense = 1.0;
  int u = 0;  ///< among all of the system
};

class Simbody : public Peer {
 public:
  explicit Simbody(const Rig& rig) : mechanism_(mechanism_of(rig)), reduction_(mechanism_) {
    for (const Link& link : mechanism_.links) add(link);
    state_ = system_.realizeTopology();
    for (Mobility& m : mobilities_) m.u = m.body.getFirstUIndex(state_) + m.index;
    const int n = state_.getNU();
    still_.resize(n);
    still_ = 0.0;
    residual_.resize(n);
    M_.resize(n, n);
    on_bodies_.resize(matter_.getNumBodies());
    on_bodies_ = SpatialVec(Vec3(0), Vec3(0));
  }

  std::string name() const override { return "Simbody"; }

  void load(const std::vector<Sample>& samples) override {
    samples_ = samples;
    own_.clear();
    angles_.clear();
    rates_.clear();
    for (const Sample& sample : samples) {
      own_.push_back(to_own(mechanism_, sample.state));
      angles_.push_back(over_mobilities(own_.back().c));
      rates_.push_back(over_mobilities(own_.back().rate));
    }
  }

  void evaluate(std::size_t i) override {
    at_ = i;
    state_.updQ() = angles_[i];
    state_.updU() = rates_[i];
    system_.realize(state_, SimTK::Stage::Velocity);
    matter_.calcM(state_, M_);
    add_wrenches(samples_[i]);
    // What the hinges would have to exert to be without acceleration; still_ is no force as well.
    matter_.calcResidualForceIgnoringConstraints(state_, still_, on_bodies_, still_, residual_);

    reduction_.clear();
    for (int r = 0; r < reduction_.hinges(); ++r) {
      const Mobility& row = mobilities_[static_cast<std::size_t>(r)];
      reduction_.add_force(r, -row.sense * residual_[row.u]);
      for (int c = 0; c <= r; ++c) {
        const Mobility& column = mobilities_[static_cast<std::size_t>(c)];
        reduction_.add_mass(r, c, row.sense * column.sense * M_(row.u, column.u));
      }
    }
    act_on_coordinates(mechanism_, own_[i].c.data(), own_[i].rate.data(), samples_[i].input,
                       [this](int c, double f) { reduction_.add_coordinate_force(c, f); });
    found_ = reduction_.solve();
  }

  model::Coordinates acceleration() const override {
    return from_own(mechanism_, samples_[at_].state, found_);
  }

 private:
  void add(const Link& link) {
    MobilizedBody parent = matter_.updGround();
    if (link.parent >= 0) parent = bodies_[static_cast<std::size_t>(link.parent)];
    Transform place(Rotation(SimTK::UnitVec3(vec(link.orientation.col(0))), SimTK::XAxis,
                             SimTK::UnitVec3(vec(link.orientation.col(2))), SimTK::ZAxis),
                    vec(link.position));
    const Vec3 cm = vec(link.cm);
    const SimTK::Inertia central(vec(link.inertia));
    const SimTK::Body::Rigid body(
        SimTK::MassProperties(link.mass, cm, central.shiftFromMassCenter(-cm, link.mass)));
    const auto& hinges = link.hinges;
    if (hinges.size() == 2) {
      bodies_.push_back(MobilizedBody::Universal(parent, place, body, Transform()));
      mobilities_.push_back({bodies_.back(), 0});
      mobilities_.push_back({bodies_.back(), 1});
      return;
    }
    if (hinges.size() == 3 && mechanism_.free_disc) {
      bodies_.push_back(MobilizedBody::Gimbal(parent, place, body, Transform()));
      for (int i = 0; i < 3; ++i) mobilities_.push_back({bodies_.back(), i});
      return;
    }
    if (hinges.size() == 3) {
      // Two turns are undone, last one first, by a universal joint with its ends exchanged.
      parent = MobilizedBody::Universal(parent, place, SimTK::Body::Massless(), Transform(),
                                        MobilizedBody::Reverse);
      mobilities_.push_back({parent, 1, -1.0});
      mobilities_.push_back({parent, 0, -1.0});
      place = Transform();
    }
    // A pin turns about z of both its frames.
    const Transform axis(Rotation(SimTK::UnitVec3(vec(hinges.back().axis)), SimTK::ZAxis));
    bodies_.push_back(MobilizedBody::Pin(parent, place * axis, body, axis));
    mobilities_.push_back({bodies_.back(), 0});
  }

  SimTK::Vector over_mobilities(const model::Coordinates& c) const {
    SimTK::Vector all(state_.getNU(), 0.0);
    for (int h = 0; h < reduction_.hinges(); ++h) {
      const Mobility& m = mobilities_[static_cast<std::size_t>(h)];
      all[m.u] = m.sense * reduction_.coefficient(h) * c[reduction_.coordinate(h)];
    }
    return all;
  }

  /// What acts on the links, weight included.
  void add_wrenches(const Sample& sample) {
    Motions motion;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Transform& place = bodies_[b].getBodyTransform(state_);
      const SpatialVec& twist = bodies_[b].getBodyVelocity(state_);
      Motion& x = motion[b];
      for (int i = 0; i < 3; ++i) x.R.col(i) = vec(place.R().col(i).asVec3());
      x.p = vec(place.p());
      x.omega = vec(twist[0]);
      x.v = vec(twist[1]);
    }
    Wrenches wrench;
    act(mechanism_, motion, sample.state.rotor_speed, sample.input, wrench);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Link& link = mechanism_.links[b];
      const Eigen::Vector3d weight(0.0, 0.0, -link.mass * model::kGravity);
      on_bodies_[bodies_[b].getMobilizedBodyIndex()] =
          SpatialVec(vec(wrench[b].moment + (motion[b].R * link.cm).cross(weight)),
                     vec(wrench[b].force + weight));
    }
  }

  Mechanism mechanism_;
  Reduction reduction_;
  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_{system_};
  std::vector<MobilizedBody> bodies_;  ///< of the links
  std::vector<Mobility> mobilities_;   ///< of the hinges
  SimTK::State state_;
  SimTK::Vector still_, residual_;
  SimTK::Matrix M_;
  SimTK::Vector_<SpatialVec> on_bodies_;
  std::vector<Sample> samples_;
  std::vector<Own> own_;
  std::vector<SimTK::Vector> angles_, rates_;  ///< of the mobilities, per sample
  std::size_t at_ = 0;
  model::Coordinates found_;
};

}  // namespace

std::unique_ptr<Peer> simbody_peer(const Rig& rig) { return std::make_unique<Simbody>(rig); }

}  // namespace gyrotwin::bench
