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
      {"gimballed.arrangement=two_pairs", "double_brennan"}};
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
  const std::set<std::string> machine{"structure", "disc", "gyros", "contact", "drive"};
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

struct Row {
  std::string takes, fallback;
  bool operator==(const Row&) const = default;
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.takes << " | " << row.fallback; }

TEST(Readme, ListsTheKeysThatTheReaderReads) {
  std::map<std::string, Row> read;
  for (const char* machine : {"umbrella", "gimballed"}) {
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
