// 40 states of all machines against an independent multibody code.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/reference_data.hpp"

namespace gyrotwin {
namespace {

class Vectors : public testing::TestWithParam<reference::Vector> {};

TEST_P(Vectors, AccelerationAgrees) {
  const reference::Vector& v = GetParam();
  const model::Coordinates a = v.machine.acceleration(v.state, v.input);
  ASSERT_EQ(static_cast<int>(v.qdd.size()), v.machine.coordinates());
  double largest = 0.0;
  for (double x : v.qdd) largest = std::max(largest, std::abs(x));
  for (std::size_t i = 0; i < v.qdd.size(); ++i) {
    EXPECT_NEAR(a[i], v.qdd[i], 1e-12 * largest) << i;  // measured 3e-14
  }
}

TEST_P(Vectors, EnergiesAgree) {
  const reference::Vector& v = GetParam();
  const model::Truth truth = v.machine.truth(v.state, v.input);
  EXPECT_NEAR(truth.kinetic_energy, v.T2, 1e-13 * v.T2);  // measured 7e-16
  EXPECT_NEAR(truth.potential_energy, v.V, 1e-13 * v.V);  // measured 1.4e-15
}

TEST_P(Vectors, ContactForcesAgree) {
  const reference::Vector& v = GetParam();
  const model::Truth truth = v.machine.truth(v.state, v.input);
  const auto expect = [](const auto& found, const std::vector<double>& expected) {
    for (std::size_t j = 0; j < found.size(); ++j) {
      const double force = j < expected.size() ? expected[j] : 0.0;
      EXPECT_NEAR(found[j], force, 1e-10 * (1.0 + force)) << j;  // measured 1.3e-12
    }
  };
  expect(truth.contact_lower, v.contact_lower);
  expect(truth.contact_upper, v.contact_upper);
}

std::string test_name(const testing::TestParamInfo<reference::Vector>& info) {
  std::string name = info.param.name;
  for (char& c : name) {
    if (c == '/') c = '_';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Reference, Vectors, testing::ValuesIn(reference::vectors()), test_name);

TEST(VectorsFile, HoldsAllVectors) { EXPECT_EQ(reference::vectors().size(), 40u); }

}  // namespace
}  // namespace gyrotwin
