// Exported logs as programs read them that share nothing with us: Python's csv, Foxglove's MCAP
// library for node, and the MAT format's description.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "services/schema/lcm_text.hpp"
#include "tests/support/mat_reader.hpp"
#include "tests/support/process.hpp"
#include "tests/support/small_log.hpp"

namespace gyrotwin {
namespace {

using support::MatValue;
using support::Process;

constexpr std::int64_t kStates = 5000;  // more than a chunk of an .mcap holds

/// A message on each channel whose every field has its own value, and many states.
class LogReaders : public testing::Test {
 protected:
  LogReaders() {
    std::string pattern = (std::filesystem::temp_directory_path() / "gyrotwin-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    LogBytes bytes = support::small_log(false).bytes;
    for (std::int64_t i = 0; i < kStates; ++i) append_state(bytes, i);
    LogWriter(folder_ / "run.lcm").append(bytes);
  }
  ~LogReaders() override { std::filesystem::remove_all(folder_); }

  static void append_state(LogBytes& bytes, std::int64_t i) {
    state_t state{};
    state.header.rig_id = support::kSampleRig;
    state.header.sequence = i == 7 ? std::int64_t{1} << 40 : i;
    state.tilt_rad[0] =
        i == 3 ? std::numeric_limits<double>::quiet_NaN() : 0.1 * static_cast<double>(i);
    state.tilt_rad[1] =
        i == 4 ? -std::numeric_limits<double>::infinity() : 1e-300 / static_cast<double>(i + 1);
    LogBytes payload(static_cast<std::size_t>(state.getEncodedSize()));
    state.encode(payload.data(), 0, state.getEncodedSize());
    append_event(bytes, {0, 1'700'000'001'000'000 + 1000 * i, "TEST/LIVE/STATE", payload});
  }

  /// `gyrotwin-log` with these arguments. @return what it printed
  std::string log(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), std::string(GYROTWIN_BIN) + "/gyrotwin-log");
    Process program(arguments, folder_ / "said.txt");
    EXPECT_EQ(program.wait(), 0) << program.output();
    return program.output();
  }
  std::string name(const char* file) const { return folder_ / file; }
  std::string cat() {
    std::ofstream(name("cat.jsonl")) << log({"cat", "--json", name("run.lcm")});
    return name("cat.jsonl");
  }
  void reads_well(const std::vector<std::string>& words) {
    Process reader(words, folder_ / "read.txt");
    EXPECT_EQ(reader.wait(300.0), 0) << reader.output();
    std::fputs(reader.output().c_str(), stdout);
  }

  std::filesystem::path folder_;
};

TEST_F(LogReaders, PythonReadsTheCsv) {
  log({"export", name("run.lcm"), name("run.csv")});
  reads_well({GYROTWIN_SOURCE_DIR "/tests/peers/csv_reader", name("run"), cat()});
}

TEST_F(LogReaders, FoxgloveReadsTheMcap) {
  std::ofstream(name("rig.toml")) << "[rig]\nname = \"test\"\n";
  const std::string program = GYROTWIN_MCAP_PEER "/read.mjs";
  log({"export", name("run.lcm"), name("run.mcap")});
  reads_well({"/usr/bin/env", "node", program, name("run.mcap"), cat(), "zstd", name("rig.toml")});
  log({"export", "--uncompressed", name("run.lcm"), name("plain.mcap")});
  reads_well(
      {"/usr/bin/env", "node", program, name("plain.mcap"), cat(), "none", name("rig.toml")});
}

/// A field of a message as the .mat should have it.
void expect_field(const MatValue& table, const LcmField& field, const std::string& column,
                  std::size_t row, std::span<const std::uint8_t> payload, std::size_t offset) {
  const MatValue& matrix = table.fields.at(column);
  SCOPED_TRACE(column);
  ASSERT_EQ(matrix.columns, field.count());
  for (std::size_t i = 0; i < field.count(); ++i) {
    const LcmNumber number{offset + field.offset + i * field.element_size(), field.primitive};
    if (field.primitive == Primitive::kInt64) {
      ASSERT_EQ(matrix.integers.at(i * matrix.rows + row), integer_at(payload, number));
    } else {
      const double theirs = matrix.numbers.at(i * matrix.rows + row);
      const double ours = number_at(payload, number);
      ASSERT_TRUE(theirs == ours || (std::isnan(theirs) && std::isnan(ours))) << theirs;
    }
  }
}

TEST_F(LogReaders, TheMatIsWhatItsFormatSays) {
  for (const bool compress : {true, false}) {
    std::vector<std::string> arguments{"export", "--force", name("run.lcm"), name("run.mat")};
    if (!compress) arguments.emplace_back("--uncompressed");
    log(arguments);
    const auto tables = support::read_mat(name("run.mat"));
    std::map<std::string, std::size_t> rows;
    Log log(folder_ / "run.lcm");
    while (const auto event = log.next()) {
      const LcmType* type = log.catalog().type_of(*event);
      if (type == nullptr || is_log_channel(event->channel)) continue;
      std::string table_name(event->channel.substr(event->channel.find('/') + 1));
      std::ranges::replace(table_name, '/', '_');
      SCOPED_TRACE(table_name);
      const MatValue& table = tables.at(table_name);
      const std::size_t row = rows[table_name]++;
      ASSERT_EQ(table.fields.at("received_us").integers.at(row), event->time_us);
      EXPECT_EQ(table.fields.at("units").fields.at("time_s").text, "s");
      for (const LcmField& field : type->fields) {
        if (field.name == "mac") continue;
        if (field.is_text) {
          EXPECT_EQ(table.fields.at(field.name).cells.at(row).text,
                    text_at(*type, event->data, field.name));
        } else if (field.type != nullptr) {
          for (const LcmField& inner : field.type->fields) {
            expect_field(table, inner, "header_" + inner.name, row, event->data, 8 + field.offset);
          }
        } else {
          expect_field(table, field, field.name, row, event->data, 8);
        }
      }
    }
    EXPECT_EQ(rows.size(), tables.size());
    EXPECT_EQ(tables.at("LIVE_STATE").fields.at("tilt_rad").rows, kStates + 1U);
    EXPECT_EQ(tables.at("LIVE_STATE").fields.at("units").fields.at("tilt_rate_rad_s").text,
              "rad/s");
  }
}

}  // namespace
}  // namespace gyrotwin
