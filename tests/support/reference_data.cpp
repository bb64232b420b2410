#include "tests/support/reference_data.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace gyrotwin::reference {

using nlohmann::json;
using namespace model;

namespace {

constexpr double kUnlimited = 1e9;
constexpr double kSlotClearance = 0.002;
// Both of tests/data/reference: a gyro unit weighs 1.3 flywheels, a stop is 200 drive torques per
// radian, and the chassis' yaw inertia is 0.6 of its roll inertia.
constexpr double kUnitPerFlywheel = 1.3;
constexpr double kStopPerTorque = 200.0;
constexpr double kYawRatio = 0.6;

std::ifstream opened(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  return file;
}

json parsed(const std::string& path) {
  std::ifstream file = opened(path);
  return json::parse(file);
}

const json& data() {
  static const json all = parsed(GYROTWIN_TEST_DATA "/reference/vectors.json");
  return all;
}

Mount mount_named(const std::string& name) {
  if (name == "level") return Mount::kLevel;
  if (name == "rigid") return Mount::kRigid;
  if (name == "universal_joint") return Mount::kUniversalJoint;
  throw std::runtime_error("unknown mount " + name);
}

TrackKind track_named(const std::string& name) {
  if (name == "none") return TrackKind::kNone;
  if (name == "lower") return TrackKind::kLower;
  if (name == "slot") return TrackKind::kSlot;
  throw std::runtime_error("unknown track " + name);
}

Arrangement arrangement_named(const std::string& name) {
  if (name == "single") return Arrangement::kSingle;
  if (name == "pair1") return Arrangement::kPair;
  if (name == "pair2") return Arrangement::kTwoPairs;
  throw std::runtime_error("unknown kind " + name);
}

Machine machine_of(const json& entry) {
  const std::string set = entry.at("parameters");
  if (!entry.contains("mount")) return build(gimballed(set));
  UmbrellaParameters parameters = umbrella(set);
  parameters.mount = mount_named(entry.at("mount"));
  parameters.track = track_named(entry.at("track"));
  return build(parameters);
}

Vector vector_of(const std::string& name, const json& entry) {
  Vector v{.name = name, .machine = machine_of(entry)};
  v.state = v.machine.state(entry.at("q"), entry.at("v"));
  v.input.mode = DriveMode::kIdealTorque;
  for (std::size_t i = 0; i < v.machine.drives.size(); ++i) {
    v.input.drive[i] =
        entry.contains("tau_nm")
            ? double{entry.at("tau_nm")}
            : double{entry.at("generalised_torque").at(v.machine.drives[i].coordinate)};
  }
  const std::vector<double> wrench = entry.at("ext");
  v.input.force = {wrench.at(0), wrench.at(1), wrench.at(2)};
  v.input.moment = {wrench.at(3), wrench.at(4), wrench.at(5)};
  v.qdd = entry.at("qdd").get<std::vector<double>>();
  v.T2 = entry.at("T2");
  v.V = entry.at("V");

  // The lower track's forces first, then the upper track's.
  const auto contact = entry.value("contact_n", std::vector<double>{});
  const auto lower = std::min<std::size_t>(contact.size(), v.machine.rotors);
  v.contact_lower.assign(contact.begin(), contact.begin() + lower);
  v.contact_upper.assign(contact.begin() + lower, contact.end());
  return v;
}

}  // namespace

std::vector<Vector> vectors() {
  std::vector<Vector> all;
  for (const auto& [name, entry] : data().at("vectors").items()) {
    all.push_back(vector_of(name, entry));
  }
  return all;
}

Trajectory trajectory(const std::string& name) {
  const std::string folder = GYROTWIN_TEST_DATA "/reference/trajectories/";
  Trajectory result;
  result.uncertainty = parsed(folder + "index.json").at(name).at("numerical_uncertainty");
  std::ifstream file = opened(folder + name + ".csv");
  std::string line;
  std::getline(file, line);  // t_s, coordinates, their rates
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    std::vector<double> numbers(std::istream_iterator<double>(row), {});
    const auto n = static_cast<std::ptrdiff_t>(numbers.size() / 2);
    const auto first = numbers.begin() + 1;
    result.samples.push_back({numbers.at(0), {first, first + n}, {first + n, numbers.end()}});
  }
  return result;
}

UmbrellaParameters umbrella(const std::string& set) {
  const json& p = data().at("umbrella_parameters").at(set);
  const auto number = [&p](const char* key) { return p.at(key).get<double>(); };
  UmbrellaParameters u;
  u.structure = {number("ms"),  number("r"),   number("Isx"),
                 number("Isy"), number("Isz"), number("cs")};
  u.disc = {number("hd"),  number("mD"), number("eD"), number("IDp"),
            number("IDz"), number("bD"), number("fcD")};
  u.gyros = {p.at("N"),     number("mg"),    number("It"),    number("Ix"),  number("Ia"),
             number("n"),   number("rp"),    number("zp"),    number("l"),   number("d"),
             number("tg0"), number("tgmin"), number("tgmax"), number("kst"), number("cg")};
  u.contact = {number("kc"), number("cc"), number("mu"), kSlotClearance};
  u.drive = {number("Jm"), {number("Kt"), number("Gr"), number("Rm"), number("Vb")}, kUnlimited};
  return u;
}

GimballedParameters gimballed(const std::string& set) {
  const json& p = data().at("pair_parameters").at(set);
  const auto number = [&p](const char* key) { return p.at(key).get<double>(); };
  GimballedParameters g;
  g.arrangement = arrangement_named(p.at("kind"));
  g.structure = {number("m"), number("zc"), number("Ixx0"), kYawRatio, number("cth")};
  g.gyros = {kUnitPerFlywheel * number("mf"),
             number("It"),
             number("Ix"),
             number("Ia"),
             number("n"),
             number("qmax"),
             kStopPerTorque * number("taumax"),
             number("cq")};
  g.torque_limit = number("taumax");
  return g;
}

}  // namespace gyrotwin::reference
