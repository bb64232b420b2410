// Tables and formulas that gyrotwin-simulate takes as inputs.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "clients/simulate/inputs.hpp"
#include "clients/simulate/series.hpp"
#include "services/runtime/error.hpp"
#include "tests/support/law_rigs.hpp"

namespace gyrotwin {
namespace {

using Values = std::vector<double>;

template <class Function>
std::string refusal(const Function& function) {
  try {
    function();
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

void expect_in(const std::string& text, std::string_view part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

Values row(const Series& series, double t) {
  const auto values = series.at(t);
  return {values.begin(), values.end()};
}

TEST(Series, HoldsEachRowUntilTheNext) {
  const Series series("# a comment\nt_s, a ,b\n0.5,1,2\r\n\n1.5,+3,-4e0\n", "x.csv");
  EXPECT_EQ(series.columns(), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(series.times(), (Values{0.5, 1.5}));
  EXPECT_EQ(row(series, -1.0), (Values{0, 0}));
  EXPECT_EQ(row(series, 0.49), (Values{0, 0}));
  EXPECT_EQ(row(series, 0.5), (Values{1, 2}));
  EXPECT_EQ(row(series, 1.49), (Values{1, 2}));
  EXPECT_EQ(row(series, 1.5), (Values{3, -4}));
  EXPECT_EQ(row(series, 1e9), (Values{3, -4}));
}

TEST(Series, TheTimeMayStandAnywhere) {
  EXPECT_EQ(row(Series("a,t_s,b\n1,2,3", "x"), 2.0), (Values{1, 3}));
}

TEST(Series, RefusalsNameTheLine) {
  const auto read = [](std::string_view text) { return refusal([&] { Series(text, "x.csv"); }); };
  expect_in(read(""), "x.csv: no rows");
  expect_in(read("t_s,a\n"), "x.csv: no rows");
  expect_in(read("1,2\n"), "x.csv:1: expected a header such as `t_s,...`");
  expect_in(read("t_s\n1\n"), "x.csv:1: expected a header");
  expect_in(read("t_s,a\n0,1,2\n"), "x.csv:2: expected 2 numbers");
  expect_in(read("t_s,a\n0,1\n\n1,nan\n"), "x.csv:4: `nan` is no finite number");
  expect_in(read("t_s,a\n0,1e999\n"), "`1e999` is no finite number");
  expect_in(read("t_s,a\n0,\n"), "`` is no finite number");
  expect_in(read("t_s,a\n0,1\n0,2\n"), "x.csv:3: time 0 is not after the one before");
}

class Inputs : public testing::Test {
 protected:
  Inputs() {
    std::string name = (std::filesystem::temp_directory_path() / "gyrotwin-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~Inputs() override { std::filesystem::remove_all(folder_); }

  std::string file(const std::string& text, const std::string& name = "in.csv") const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  template <class Value>
  Value at(const InputFunction<Value>& input, double t) const {
    const model::State state = two_pairs_.state({0.1, 0.2, 0.3, 0.4}, {1, 2, 3, 4});
    return input.value({t, t, state});
  }
  DriveTorques torque(const std::vector<std::string>& arguments, double t) const {
    return at(torque_input(arguments, two_pairs_), t);
  }
  std::string torque_refusal(const std::vector<std::string>& arguments) const {
    return refusal([&] { torque_input(arguments, two_pairs_); });
  }
  std::string external_refusal(const std::vector<std::string>& arguments) const {
    return refusal([&] { external_input(arguments, two_pairs_); });
  }

  std::filesystem::path folder_;
  const model::Machine two_pairs_ = reference::double_brennan().build_machine();
};

TEST_F(Inputs, TorqueFormulasGoToTheDrives) {
  EXPECT_EQ(torque({"10*thx", "qB_dot + t"}, 2.0), (DriveTorques{1.0, 6.0}));
  EXPECT_EQ(torque({"qB=7", "qA = thy_dot"}, 0.0), (DriveTorques{2.0, 7.0}));
  EXPECT_EQ(torque({"qB=7"}, 0.0), (DriveTorques{0.0, 7.0}));
}

TEST_F(Inputs, TorqueTablesGoToTheDrives) {
  for (const char* header : {"t_s,first,second", "t_s,qA_nm,qB_nm", "t_s,qA,qB"}) {
    EXPECT_EQ(torque({file(std::string(header) + "\n0,1,2\n")}, 0.0), (DriveTorques{1.0, 2.0}));
  }
  EXPECT_EQ(torque({file("t_s,qB_nm,qA_nm\n0,1,2\n")}, 0.0), (DriveTorques{2.0, 1.0}));
  EXPECT_EQ(torque({file("t_s,qB\n0,1\n", "no_ending")}, 0.0), (DriveTorques{0.0, 1.0}));
  EXPECT_EQ(torque_input({file("t_s,qB\n0,1\n3,4\n")}, two_pairs_).breakpoints, (Values{0, 3}));
}

TEST_F(Inputs, ExternalColumnsStandInAnyOrder) {
  const auto input = external_input({file("mz_nm,t_s,fx_n,my\n1,0.5,2,3\n")}, two_pairs_);
  EXPECT_EQ(input.breakpoints, Values{0.5});
  EXPECT_EQ(at(input, 0.4).force, Eigen::Vector3d::Zero());
  EXPECT_EQ(at(input, 0.5).force, Eigen::Vector3d(2, 0, 0));
  EXPECT_EQ(at(input, 0.5).moment, Eigen::Vector3d(0, 3, 1));
  EXPECT_EQ(at(external_input({"mx=2*t", "fz=-1"}, two_pairs_), 3.0).moment,
            Eigen::Vector3d(6, 0, 0));
  EXPECT_FALSE(external_input({}, two_pairs_).value);
}

TEST_F(Inputs, RefusalsNamePlaceAndFix) {
  expect_in(torque_refusal({"1"}),
            "--torque: 1 without a name; give one for each drive in this "
            "order, or name them: `--torque qA=FORMULA`; names: qA, qB");
  expect_in(torque_refusal({"qA=1", "2"}), "some with a name and some without");
  expect_in(torque_refusal({"qC=1"}), "unknown name `qC`; known: qA, qB");
  expect_in(torque_refusal({"qA=1", "qA=1"}), "qA is given twice");
  expect_in(torque_refusal({"qA=2*qa"}), "--torque: column 6: unknown name `qa`");
  expect_in(torque_refusal({(folder_ / "none.csv").string()}), "none.csv: cannot be read: No such");
  expect_in(torque_refusal({file("t_s,a\n0,1\n")}),
            "1 columns beside the time, expected one for "
            "each drive: qA, qB");
  expect_in(torque_refusal({file("t_s,qA,b\n0,1,2\n")}), "unknown name `b`");
  expect_in(torque_refusal({file("t_s,qA,qA_nm\n0,1,2\n")}), "two columns for qA");
  expect_in(torque_refusal({file("t_s,qA\n0,1\n"), "1"}), "a CSV file stands alone");
  expect_in(external_refusal({"1"}), "names: fx, fy, fz, mx, my, mz");
  expect_in(external_refusal({file("t_s,force\n0,1\n")}), "unknown name `force`; known: fx");
}

}  // namespace
}  // namespace gyrotwin
