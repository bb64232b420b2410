#include "services/runtime/rig.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <system_error>

#include "services/runtime/error.hpp"
#include "services/runtime/rig_reader.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

namespace fs = std::filesystem;

std::string shipped_list(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

/// The prefix of an installed program, which stands in its bin.
fs::path prefix() {
  std::error_code none;
  return fs::read_symlink("/proc/self/exe", none).parent_path().parent_path();
}

fs::path installed_rigs() { return prefix() / "share/gyrotwin/rigs"; }

/// Names of the rig files in a folder, in order.
std::vector<std::string> rigs_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, none)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// A host's own rigs come before those that the program was installed with; where it runs from its
/// source tree, or a folder is named, there are none.
fs::path host_rigs() {
  if (rig_folder() != installed_rigs()) return {};
  return (prefix() == "/usr" ? "/etc" : prefix() / "etc") / fs::path("gyrotwin/rigs");
}

fs::path find_rig(const std::string& name_or_path) {
  if (name_or_path.find('/') != std::string::npos || name_or_path.ends_with(".toml")) {
    return name_or_path;
  }
  std::vector<std::string> names;
  for (const fs::path& folder : {host_rigs(), rig_folder()}) {
    for (const std::string& name : rigs_in(folder)) {
      if (name == name_or_path) return folder / (name + ".toml");
      names.push_back(name);
    }
  }
  const std::vector<std::string_view> candidates(names.begin(), names.end());
  throw Error("no shipped rig is called `" + name_or_path + "`: there are " + shipped_list(names) +
              " (a file of your own is given by its path, with a / or ending in .toml)" +
              did_you_mean(nearest(name_or_path, candidates)));
}

std::string read_text(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  std::error_code none;
  if (stream && fs::is_regular_file(file, none)) return text.str();
  throw Error(file.string() + (fs::exists(file, none)
                                   ? " cannot be read; it is to be a TOML file you may read"
                                   : " does not exist; shipped rigs, given by bare name: " +
                                         shipped_list(shipped_rigs())));
}

struct Loaded {
  Rig rig;
  std::string effective;
};

Loaded load(const std::string& name_or_path, const std::vector<std::string>& overrides) {
  const fs::path file = find_rig(name_or_path);
  TomlReader reader(read_text(file), file.string(), overrides);
  Rig rig = read_rig(reader);
  reader.finish();
  rig.file = file;
  return {std::move(rig), reader.effective()};
}

}  // namespace

Eigen::Matrix3d Rig::Sensors::imu_axes() const {
  using Eigen::Vector3d;
  return (Eigen::AngleAxisd(imu_orientation.x(), Vector3d::UnitX()) *
          Eigen::AngleAxisd(imu_orientation.y(), Vector3d::UnitY()) *
          Eigen::AngleAxisd(imu_orientation.z(), Vector3d::UnitZ()))
      .toRotationMatrix();
}

model::Machine Rig::build_machine() const {
  model::Machine built =
      std::visit([](const auto& parameters) { return model::build(parameters); }, machine);
  built.rotor_drive = rotor_drive;
  built.load_cell = load_cell;
  return built;
}

model::State Rig::initial_state(const model::Machine& built) const {
  model::State state = built.state(initial_q, initial_v);
  for (double& speed : state.rotor_speed) speed *= initial_rotor_share;
  return state;
}

Rig load_rig(const std::string& name_or_path, const std::vector<std::string>& overrides) {
  return load(name_or_path, overrides).rig;
}

std::string print_rig(const std::string& name_or_path, const std::vector<std::string>& overrides) {
  const Loaded loaded = load(name_or_path, overrides);
  return "# " + loaded.rig.file.string() + ", defaults and overrides included\n" + loaded.effective;
}

std::filesystem::path rig_folder() {
  if (const char* named = std::getenv("GYROTWIN_RIGS"); named && *named) {
    if (fs::is_directory(named)) return named;
    throw Error("GYROTWIN_RIGS names `" + std::string(named) +
                "`, which is no folder; correct it, or unset it to use the shipped rigs");
  }
  std::error_code none;
  fs::path installed = installed_rigs();
  if (fs::is_directory(installed, none)) return installed;
  fs::path in_source_tree = GYROTWIN_SOURCE_RIGS;
  if (fs::is_directory(in_source_tree, none)) return in_source_tree;
  throw Error("no folder of shipped rigs: looked for " + installed.string() + " and " +
              in_source_tree.string() + "; set GYROTWIN_RIGS to the folder with the rig files");
}

std::vector<std::string> shipped_rigs() { return rigs_in(rig_folder()); }

std::string_view name_of(LawKind law) {
  const auto* word = std::find_if(kLawWords.begin(), kLawWords.end(),
                                  [&](const auto& candidate) { return candidate.value == law; });
  return word->name;
}

}  // namespace gyrotwin
