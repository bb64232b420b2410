// The rigs in deploy/rigs: their numbers are the reference's, and their README lists the reader's
// keys.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "services/runtime/error.hpp"
#include "services/runtime/rig.hpp"
#include "services/runtime/rig_reader.hpp"

namespace gyrotwin {
namespace {

using nlohmann::json;

const json& reference() {
  static const json data =
      json::parse(std::ifstream(rig_folder() / "../../tests/data/reference/vectors.json"));
  return data;
}

/// Compared as it is: a rig's numbers are the reference's to the last bit.
void expect_umbrella(const model::UmbrellaParameters& p, const json& r) {
  const auto& [mass, cm_height, Isx, Isy, Isz, cs] = p.structure;
  const std::map<std::string, double> values{{"ms", mass},
                                             {"r", cm_height},
                                             {"Isx", Isx},
                                             {"Isy", Isy},
                                             {"Isz", Isz},
                                             {"cs", cs},
                                             {"hd", p.disc.joint_height},
                                             {"mD", p.disc.mass},
                                             {"eD", p.disc.cm_offset},
                                             {"IDp", p.disc.inertia_planar},
                                             {"IDz", p.disc.inertia_polar},
                                             {"bD", p.disc.viscous_friction},
                                             {"fcD", p.disc.coulomb_friction},
                                             {"N", p.gyros.count},
                                             {"mg", p.gyros.mass},
                                             {"It", p.gyros.inertia_transverse},
                                             {"Ix", p.gyros.inertia_axial},
                                             {"Ia", p.gyros.rotor_inertia},
                                             {"n", p.gyros.rotor_speed},
                                             {"rp", p.gyros.pivot_radius},
                                             {"zp", p.gyros.pivot_height},
                                             {"l", p.gyros.axle_length},
                                             {"d", p.gyros.cm_distance},
                                             {"tg0", p.gyros.ring_elevation},
                                             {"tgmin", p.gyros.stop_lower},
                                             {"tgmax", p.gyros.stop_upper},
                                             {"kst", p.gyros.stop_stiffness},
                                             {"cg", p.gyros.damping},
                                             {"kc", p.contact.stiffness},
                                             {"cc", p.contact.damping},
                                             {"mu", p.contact.rolling_drag},
                                             {"Jm", p.drive.motor_inertia},
                                             {"Kt", p.drive.motor.torque_constant},
                                             {"Gr", p.drive.motor.gear_ratio},
                                             {"Rm", p.drive.motor.resistance},
                                             {"Vb", p.drive.motor.supply_voltage}};
  EXPECT_EQ(values.size(), r.size());
  for (const auto& [name, value] : values) EXPECT_EQ(value, r.at(name).get<double>()) << name;
  EXPECT_EQ(p.contact.slot_clearance, 0.002);
  EXPECT_EQ(p.bushing.stiffness, 0.0);
  EXPECT_EQ(p.bushing.rotating_damping, 0.0);
  EXPECT_EQ(p.bushing.standing_damping, 0.0);
}

void expect_gimballed(const model::GimballedParameters& p, const json& r) {
  const std::map<std::string, double> values{{"m", p.structure.mass},
                                             {"zc", p.structure.cm_height},
                                             {"Ixx0", p.structure.inertia_tilt},
                                             {"cth", p.structure.damping},
                                             {"It", p.gyros.inertia_transverse},
                                             {"Ix", p.gyros.inertia_axial},
                                             {"Ia", p.gyros.rotor_inertia},
                                             {"n", p.gyros.rotor_speed},
                                             {"cq", p.gyros.damping},
                                             {"qmax", p.gyros.stop},
                                             {"taumax", p.torque_limit}};
  for (const auto& [name, value] : values) EXPECT_EQ(value, r.at(name).get<double>()) << name;
  EXPECT_EQ(p.gyros.mass, 1.3 * r.at("mf").get<double>());
  EXPECT_EQ(p.gyros.stop_stiffness, 200.0 * r.at("taumax").get<double>());
  EXPECT_EQ(p.structure.inertia_yaw_ratio, 0.6);
  const std::map<std::string, model::Arrangement> kinds{{"single", model::Arrangement::kSingle},
                                                        {"pair1", model::Arrangement::kPair},
                                                        {"pair2", model::Arrangement::kTwoPairs}};
  EXPECT_EQ(p.arrangement, kinds.at(r.at("kind")));
}

TEST(ShippedRigs, NumbersAreTheReferences) {
  std::set<std::string> compared;
  for (const auto& [name, parameters] : reference().at("umbrella_parameters").items()) {
    SCOPED_TRACE(name);
    expect_umbrella(std::get<model::UmbrellaParameters>(load_rig(name).machine), parameters);
    compared.insert(name);
  }
  for (const auto& [name, parameters] : reference().at("pair_parameters").items()) {
    SCOPED_TRACE(name);
    expect_gimballed(std::get<model::GimballedParameters>(load_rig(name).machine), parameters);
    compared.insert(name);
  }
  {
    SCOPED_TRACE("load_cell_rig");  // is prototype_b against a cell
    expect_umbrella(std::get<model::UmbrellaParameters>(load_rig("load_cell_rig").machine),
                    reference().at("umbrella_parameters").at("prototype_b"));
    compared.insert("load_cell_rig");
  }
  compared.insert("simple_gyroscope");  // which no reference has
  const std::vector<std::string> shipped = shipped_rigs();
  EXPECT_EQ(compared, std::set<std::string>(shipped.begin(), shipped.end()));
}

TEST(ShippedRigs, CannotMeetOnOneNetwork) {
  std::set<int> ids, ports;
  std::set<std::string> groups, prefixes;
  for (const std::string& name : shipped_rigs()) {
    const Rig rig = load_rig(name);
    EXPECT_EQ(rig.name, name);
    EXPECT_EQ(rig.network.interface, "lo");
    EXPECT_EQ(rig.network.ttl, 0);
    EXPECT_TRUE(rig.network.sign);
    EXPECT_TRUE(ids.insert(rig.id).second) << name;
    EXPECT_TRUE(ports.insert(rig.network.port).second) << name;
    EXPECT_TRUE(groups.insert(rig.network.group).second) << name;
    EXPECT_TRUE(prefixes.insert(rig.network.prefix).second) << name;
  }
}

TEST(ShippedRigs, InitialStateFitsTheMachineThatIsBuilt) {
  for (const std::string& name : shipped_rigs()) {
    const Rig rig = load_rig(name);
    const model::Machine machine = rig.build_machine();
    EXPECT_EQ(rig.initial_q.size(), machine.layout.names.size()) << name;
    if (std::holds_alternative<model::GyroscopeParameters>(rig.machine)) continue;
    // Small and honest: it stands, but not upright.
    const double tilt = machine.tilt(machine.state(rig.initial_q, rig.initial_v));
    EXPECT_GT(tilt, 0.01) << name;
    EXPECT_LT(tilt, 0.05) << name;
  }
}

TEST(ShippedRigs, ReaderNamesTheCoordinatesOfTheModel) {
  const std::map<std::string, std::string> kinds{
      {"umbrella.mount=level", "prototype_b"},
      {"umbrella.mount=rigid", "prototype_b"},
      {"umbrella.mount=universal_joint", "prototype_b_sleeping"},
      {"gimballed.arrangement=single", "gyrocar"},
      {"gimballed.arrangement=pair", "gyrocar"},
      {"gimballed.arrangement=two_pairs", "double_brennan"},
      {"rig.machine=gyroscope", "simple_gyroscope"}};
  for (const auto& [kind, rig] : kinds) {
    std::string names;
    for (const std::string& name : load_rig(rig, {kind}).build_machine().layout.names) {
      names += (names.empty() ? "(" : ", ") + name;
    }
    try {
      load_rig(rig, {kind, "initial.q=[]"});
      FAIL() << kind;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(names + ')'), std::string::npos) << error.what();
    }
  }
}

TEST(ShippedRigs, EveryNumberOfTheMachineSaysWhereItComesFrom) {
  const std::set<std::string> machine{"structure", "disc",        "gyros",     "contact", "drive",
                                      "gyroscope", "rotor_drive", "load_cell", "wind"};
  for (const std::string& name : shipped_rigs()) {
    std::ifstream file(rig_folder() / (name + ".toml"));
    std::string table;
    for (std::string line; std::getline(file, line);) {
      if (line.starts_with('[')) table = line.substr(1, line.find(']') - 1);
      if (machine.contains(table) && line.find('=') != std::string::npos) {
        EXPECT_NE(line.find('#'), std::string::npos) << name << ": " << line;
      }
    }
  }
}

// T = I omega Omega: what the weight does about the hinge is what the precession turns away.
TEST(ShippedRigs, SimpleGyroscopePrecessesUnderItsWeight) {
  const Rig rig = load_rig("simple_gyroscope");
  const auto& gyro = std::get<model::GyroscopeParameters>(rig.machine).gyro;
  const double weight = gyro.mass * model::kGravity * gyro.cm_distance;
  EXPECT_NEAR(gyro.rotor_inertia * gyro.rotor_speed * rig.initial_v[0], weight, 2e-3 * weight);
  EXPECT_EQ(-rig.controller.disc_speed.value(), rig.initial_v[0]);
}

TEST(ShippedRigs, HaveTheNumbersOfTheseLaws) {
  const std::string disc = "constant_speed tilt_to_speed momentum_manager reduced_lqr ";
  const std::string gimbals = "precession shelf precession_lqr ";
  const std::map<std::string, std::string> expected{
      {"prototype_a", "open_loop " + disc},
      {"prototype_b", "open_loop " + disc},
      {"prototype_b_sleeping", "constant_speed "},
      {"gooch", disc},
      {"townsend", disc},
      {"brennan_monorail", gimbals},
      {"double_brennan", gimbals},
      {"gyrocar", gimbals},
      {"load_cell_rig", "open_loop constant_speed "},
      {"simple_gyroscope", "open_loop constant_speed "}};
  for (const std::string& name : shipped_rigs()) {
    std::string laws;
    for (const auto& [word, law] : kLawWords) {
      if (law == LawKind::kNone) continue;
      try {
        EXPECT_EQ(load_rig(name, {"controller.law=" + std::string(word)}).controller.law, law);
        laws += std::string(word) + ' ';
      } catch (const Error&) {
      }
    }
    EXPECT_EQ(laws, expected.at(name)) << name;
  }
}

/// How long the first rotor takes [s] to this share of its nominal speed, powered or not.
double rotor_time(const model::Machine& machine, double from, double to, bool powered) {
  constexpr double kStep = 0.01;  // [s]
  model::State state = machine.state({}, {});
  const double nominal = state.rotor_speed[0];
  state.rotor_speed[0] = from * nominal;
  model::Input input;
  input.rotor_powered.fill(powered);
  double time = 0.0;
  while ((to - state.rotor_speed[0] / nominal) * (to - from) > 0.0 && time < 1e5) {
    state.rotor_speed[0] += kStep * machine.rotor_acceleration(state, input)[0];
    time += kStep;
  }
  return time;
}

TEST(ShippedRigs, RotorsStartAtSpeedAndKeepIt) {
  for (const std::string& name : shipped_rigs()) {
    const Rig rig = load_rig(name);
    ASSERT_TRUE(rig.rotor_drive) << name;
    const model::Machine machine = rig.build_machine();
    const model::State state = rig.initial_state(machine);
    EXPECT_EQ(state.rotor_speed, machine.nominal_rotor_speed) << name;
    for (const double rate : machine.rotor_acceleration(state, {})) EXPECT_EQ(rate, 0.0) << name;
  }
}

TEST(ShippedRigs, RotorsSpinUpAndCoastDownAsTheirFilesSay) {
  struct Times {
    double up, down;  // to 99 % of the speed, to 1 % [s]
  };
  const std::map<std::string, Times> expected{{"prototype_a", {10.6, 95}},
                                              {"prototype_b", {25, 260}},
                                              {"prototype_b_sleeping", {25, 260}},
                                              {"gooch", {23.7, 265}},
                                              {"townsend", {135, 490}},
                                              {"brennan_monorail", {262, 3500}},
                                              {"double_brennan", {25, 260}},
                                              {"gyrocar", {180, 1520}},
                                              {"load_cell_rig", {25, 260}},
                                              {"simple_gyroscope", {18.0, 320}}};
  for (const std::string& name : shipped_rigs()) {
    const model::Machine machine = load_rig(name).build_machine();
    const auto [up, down] = expected.at(name);
    EXPECT_NEAR(rotor_time(machine, 0.0, 0.99, true), up, 0.05 * up) << name;
    EXPECT_NEAR(rotor_time(machine, 1.0, 0.01, false), down, 0.05 * down) << name;
  }
}

struct Row {
  std::string takes, fallback;
  bool operator==(const Row&) const = default;
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.takes << " | " << row.fallback; }

TEST(Readme, ListsTheKeysThatTheReaderReads) {
  std::map<std::string, Row> read;
  for (const char* machine : {"umbrella", "gimballed", "gyroscope"}) {
    for (const TomlReader::Key& key : rig_keys(machine)) {
      const std::string fallback = key.need == Need::kRequired ? "required"
                                   : key.value.empty()         ? "unset"
                                                               : '`' + key.value + '`';
      read[key.path()] = {key.takes, fallback};
    }
  }

  std::map<std::string, Row> listed;
  std::ifstream readme(rig_folder() / "README.md");
  for (std::string line; std::getline(readme, line);) {
    if (!line.starts_with("| `") || line.find('.') > line.find("` |")) continue;
    std::istringstream cells(line.substr(2));
    const auto cell = [&] {
      std::string text;
      std::getline(cells, text, '|');
      return text.substr(1, text.size() - 2);
    };
    std::string key;
    std::getline(cells, key, '|');
    key = key.substr(1, key.size() - 3);
    const std::string takes = cell();
    listed[key] = {takes, cell()};
  }
  EXPECT_EQ(listed, read);
}

}  // namespace
}  // namespace gyrotwin
