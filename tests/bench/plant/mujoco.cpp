#include "tests/bench/plant/mujoco.hpp"

#include <cstring>
#include <iomanip>
#include <sstream>

#include "services/runtime/error.hpp"

namespace gyrotwin::bench {

using Eigen::Vector3d;

namespace {

std::string vec(const Vector3d& v) {
  std::ostringstream out;
  out << std::setprecision(17) << v.x() << ' ' << v.y() << ' ' << v.z();
  return out.str();
}

std::string quat(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  std::ostringstream out;
  out << std::setprecision(17) << q.w() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z();
  return out.str();
}

/// Hinges are numbered in the order of links: their first one with coefficient 1 leads.
std::vector<int> leaders(const Reduction& reduction, int coordinates) {
  std::vector<int> leader(static_cast<std::size_t>(coordinates), -1);
  for (int h = reduction.hinges() - 1; h >= 0; --h) {
    if (reduction.coefficient(h) == 1.0) {
      leader[static_cast<std::size_t>(reduction.coordinate(h))] = h;
    }
  }
  return leader;
}

/// A link and, inside it, what it carries. Links are in depth-first order.
std::size_t add_body(std::ostream& out, const Mechanism& mechanism, std::size_t b, int& hinge) {
  const Link& link = mechanism.links[b];
  out << "<body pos='" << vec(link.position) << "' quat='" << quat(link.orientation) << "'>\n"
      << "<inertial pos='" << vec(link.cm) << "' mass='" << link.mass << "' diaginertia='"
      << vec(link.inertia) << "'/>\n";
  for (const Hinge& h : link.hinges) {
    out << "<joint name='h" << hinge++ << "' type='hinge' axis='" << vec(h.axis) << "'/>\n";
  }
  std::size_t next = b + 1;
  while (next < mechanism.links.size() && mechanism.links[next].parent == static_cast<int>(b)) {
    next = add_body(out, mechanism, next, hinge);
  }
  out << "</body>\n";
  return next;
}

mjModel* load(const std::string& mjcf) {
  const auto vfs = std::make_unique<mjVFS>();
  mj_defaultVFS(vfs.get());
  mj_makeEmptyFileVFS(vfs.get(), "machine.xml", static_cast<int>(mjcf.size()));
  std::memcpy(vfs->filedata[mj_findFileVFS(vfs.get(), "machine.xml")], mjcf.data(), mjcf.size());
  char error[500] = "";
  mjModel* model = mj_loadXML("machine.xml", vfs.get(), error, sizeof error);
  mj_deleteVFS(vfs.get());
  if (model == nullptr) throw Error(std::string("MuJoCo refuses the machine: ") + error);
  return model;
}

// MuJoCo's callbacks are global: whose forces they add, while it works.
MujocoMachine* acting = nullptr;

// MuJoCo lets a constraint of impedance d give way by (1 - d)/d of what the unconstrained machine
// would, and bounds d by 0.9999, with which the rigs' accelerations are off by up to 4e-3.
constexpr double kSharpening = 1e-5;

}  // namespace

std::string mjcf_of(const Mechanism& mechanism, const MjcfOptions& options) {
  const Reduction reduction(mechanism);
  const std::vector<int> leader = leaders(reduction, mechanism.coordinates);
  std::ostringstream out;
  out << std::setprecision(17);
  // All constraints are equations, so that one step of Newton's method solves them.
  out << "<mujoco><compiler angle='radian' inertiafromgeom='false'/>\n"
      << "<option timestep='" << options.timestep << "' gravity='0 0 " << -model::kGravity
      << "' integrator='RK4' solver='Newton' jacobian='dense' iterations='1' tolerance='1e-14'>\n"
      << "<flag contact='disable' limit='disable' frictionloss='disable' sensor='disable'"
      << " refsafe='disable'/></option>\n<worldbody>\n";
  int hinge = 0;
  add_body(out, mechanism, 0, hinge);
  out << "</worldbody>\n";
  if (options.gears == Gears::kConstraints) {
    out << "<equality>\n";
    for (int h = 0; h < reduction.hinges(); ++h) {
      const int first = leader[static_cast<std::size_t>(reduction.coordinate(h))];
      if (h == first) continue;
      // As hard as MuJoCo has them.
      out << "<joint joint1='h" << h << "' joint2='h" << first << "' polycoef='0 "
          << reduction.coefficient(h) << " 0 0 0' solref='" << options.constraint_time
          << " 1' solimp='0.9999 0.9999 0.001'/>\n";
    }
    out << "</equality>\n";
  }
  out << "</mujoco>\n";
  return out.str();
}

MujocoMachine::MujocoMachine(const Mechanism& mechanism, const MjcfOptions& options)
    : mechanism_(mechanism),
      reduction_(mechanism),
      leader_(leaders(reduction_, mechanism.coordinates)),
      model_(load(mjcf_of(mechanism, options))),
      data_(mj_makeData(model_.get())) {
  mjcb_passive = &MujocoMachine::passive;
}

void MujocoMachine::place(const Own& own) {
  reduction_.spread(own.c, data_->qpos);
  reduction_.spread(own.rate, data_->qvel);
}

model::Coordinates MujocoMachine::coordinates(const mjtNum* per_hinge) const {
  model::Coordinates c = model::Coordinates::Zero();
  for (std::size_t i = 0; i < leader_.size(); ++i) {
    c[static_cast<Eigen::Index>(i)] = per_hinge[leader_[i]];
  }
  return c;
}

void MujocoMachine::add_wrenches(const mjData& d, mjtNum* on_hinges) {
  const std::size_t links = mechanism_.links.size();
  const Vector3d com = Eigen::Map<const Vector3d>(d.subtree_com + 3);  // of the whole machine
  Motions motion;
  for (std::size_t b = 0; b < links; ++b) {
    const mjtNum* velocity = d.cvel + 6 * (b + 1);  // of the point of the body at com
    Motion& x = motion[b];
    x.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(d.xmat + 9 * (b + 1));
    x.p = Eigen::Map<const Vector3d>(d.xpos + 3 * (b + 1));
    x.omega = Eigen::Map<const Vector3d>(velocity);
    x.v = Eigen::Map<const Vector3d>(velocity + 3) + x.omega.cross(x.p - com);
  }
  Wrenches wrench;
  act(mechanism_, motion, *rotor_speed_, *input_, wrench);

  // About com as MuJoCo's motion axes are, each body's with those that it carries.
  for (std::size_t b = 0; b < links; ++b) {
    wrench[b].moment += (motion[b].p - com).cross(wrench[b].force);
  }
  for (std::size_t b = links - 1; b > 0; --b) {
    Wrench& parent = wrench[static_cast<std::size_t>(mechanism_.links[b].parent)];
    parent.moment += wrench[b].moment;
    parent.force += wrench[b].force;
  }
  for (int h = 0; h < model_->nv; ++h) {
    const mjtNum* axis = d.cdof + 6 * h;
    const Wrench& w = wrench[static_cast<std::size_t>(model_->dof_bodyid[h] - 1)];
    on_hinges[h] += Eigen::Map<const Vector3d>(axis).dot(w.moment) +
                    Eigen::Map<const Vector3d>(axis + 3).dot(w.force);
  }
}

void MujocoMachine::passive(const mjModel*, mjData* d) {
  if (acting == nullptr) return;
  MujocoMachine& self = *acting;
  self.add_wrenches(*d, d->qfrc_passive);
  const model::Coordinates c = self.coordinates(d->qpos), rate = self.coordinates(d->qvel);
  act_on_coordinates(self.mechanism_, c.data(), rate.data(), *self.input_, [&](int i, double f) {
    d->qfrc_passive[self.leader_[static_cast<std::size_t>(i)]] += f;
  });
  for (int i = 0; i < d->nefc; ++i) {
    d->efc_R[i] *= kSharpening;
    d->efc_D[i] /= kSharpening;
  }
}

void MujocoMachine::forward() {
  acting = this;
  mj_forward(model_.get(), data_.get());
  acting = nullptr;
}

void MujocoMachine::step() {
  acting = this;
  mj_step(model_.get(), data_.get());
  acting = nullptr;
}

model::Coordinates MujocoMachine::projected() {
  const mjModel* m = model_.get();
  mjData* d = data_.get();
  mj_kinematics(m, d);
  mj_comPos(m, d);
  mj_crb(m, d);
  mj_comVel(m, d);
  mj_rne(m, d, 0, d->qfrc_bias);
  mju_zero(d->qfrc_passive, m->nv);
  add_wrenches(*d, d->qfrc_passive);

  reduction_.clear();
  for (int i = 0; i < m->nv; ++i) {
    reduction_.add_force(i, d->qfrc_passive[i] - d->qfrc_bias[i]);
    // A row of MuJoCo's sparse inertia: the diagonal, then towards the root.
    int address = m->dof_Madr[i];
    for (int j = i; j >= 0; j = m->dof_parentid[j]) reduction_.add_mass(i, j, d->qM[address++]);
  }
  const model::Coordinates c = coordinates(d->qpos), rate = coordinates(d->qvel);
  act_on_coordinates(mechanism_, c.data(), rate.data(), *input_,
                     [&](int i, double f) { reduction_.add_coordinate_force(i, f); });
  return reduction_.solve();
}

namespace {

class MujocoPeer : public Peer {
 public:
  MujocoPeer(const Rig& rig, Gears gears)
      : gears_(gears), machine_(mechanism_of(rig), {.gears = gears}) {}

  std::string name() const override {
    return gears_ == Gears::kConstraints ? "MuJoCo" : "MuJoCo projected";
  }
  void load(const std::vector<Sample>& samples) override {
    samples_.assign(samples.begin(), samples.end());
    own_.clear();
    for (const Sample& sample : samples) own_.push_back(to_own(machine_.mechanism(), sample.state));
  }
  void evaluate(std::size_t i) override {
    at_ = i;
    machine_.act_by(samples_[i].state.rotor_speed, samples_[i].input);
    machine_.place(own_[i]);
    if (gears_ == Gears::kConstraints) {
      machine_.forward();
    } else {
      projected_ = machine_.projected();
    }
  }
  model::Coordinates acceleration() const override {
    const model::Coordinates own =
        gears_ == Gears::kConstraints ? machine_.coordinates(machine_.data().qacc) : projected_;
    return from_own(machine_.mechanism(), samples_[at_].state, own);
  }

 private:
  Gears gears_;
  MujocoMachine machine_;
  std::vector<Sample> samples_;
  std::vector<Own> own_;
  std::size_t at_ = 0;
  model::Coordinates projected_;
};

}  // namespace

std::unique_ptr<Peer> mujoco_peer(const Rig& rig) {
  return std::make_unique<MujocoPeer>(rig, Gears::kConstraints);
}

std::unique_ptr<Peer> mujoco_projected_peer(const Rig& rig) {
  return std::make_unique<MujocoPeer>(rig, Gears::kProjection);
}

}  // namespace gyrotwin::bench
