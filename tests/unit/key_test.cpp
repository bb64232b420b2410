#include "services/runtime/key.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <string>

#include "clients/key/check.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for every test, and an environment without any of the three variables.
class KeyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "gyrotwin_key_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    unsetenv("GYROTWIN_KEYS");
    unsetenv("XDG_CONFIG_HOME");
    unsetenv("HOME");
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// A key file with this content and mode.
  fs::path file(const std::string& content, mode_t mode = 0600) const {
    fs::path path = folder_ / "rig.key";
    std::ofstream(path) << content;
    chmod(path.c_str(), mode);
    return path;
  }

  /// What load_key says against a file; empty when it takes it.
  static std::string refusal(const fs::path& path) {
    try {
      load_key(path);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }

  fs::path folder_;
};

mode_t mode_of(const fs::path& path) {
  struct stat status {};
  EXPECT_EQ(stat(path.c_str(), &status), 0) << path;
  return status.st_mode & 07777;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

const std::string kHex = "000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f";

TEST_F(KeyTest, PathFollowsTheEnvironment) {
  EXPECT_THROW(key_path("rig"), Error);
  setenv("HOME", "/h", 1);
  EXPECT_EQ(key_path("rig"), "/h/.config/gyrotwin/rig.key");
  setenv("XDG_CONFIG_HOME", "/x", 1);
  EXPECT_EQ(key_path("rig"), "/x/gyrotwin/rig.key");
  setenv("GYROTWIN_KEYS", "/k", 1);
  EXPECT_EQ(key_path("rig"), "/k/rig.key");
}

TEST_F(KeyTest, LoadsWhatIsWritten) {
  const Key key = load_key(file(kHex + "\n"));
  for (std::size_t i = 0; i < key.size(); ++i) EXPECT_EQ(key[i], i);
}

TEST_F(KeyTest, RefusesWhatIsNoKey) {
  const std::string z = kHex.substr(1);
  for (const std::string& bad :
       {std::string(), kHex, kHex + " ", kHex + "\n\n", kHex + "0\n", z + "\n", "g" + z + "\n",
        z + "\n ", kHex + "\r\n", std::string(1000, 'a')}) {
    const fs::path path = file(bad);
    EXPECT_TRUE(contains(refusal(path), path.string() + ": expected 64 hex digits")) << bad;
    EXPECT_TRUE(contains(refusal(path), "`gyrotwin key new --rig rig`")) << bad;
  }
}

TEST_F(KeyTest, RefusesAFileThatOthersCanRead) {
  for (const mode_t mode : {0640U, 0604U, 0660U, 0622U, 0644U}) {
    const fs::path path = file(kHex + "\n", mode);
    EXPECT_TRUE(contains(refusal(path), "`chmod 600 " + path.string() + "`")) << mode;
  }
  EXPECT_EQ(refusal(file(kHex + "\n", 0400)), "");
}

// There the group's bits may be the mask of an access list.
TEST_F(KeyTest, ACredentialOfSystemdMayHaveAnAccessList) {
  const fs::path path = file(kHex + "\n", 0440);
  EXPECT_NE(refusal(path), "");
  setenv("CREDENTIALS_DIRECTORY", folder_.c_str(), 1);
  EXPECT_EQ(refusal(path), "");
  EXPECT_NE(refusal(file(kHex + "\n", 0444)), "");
  setenv("CREDENTIALS_DIRECTORY", "/run/credentials/other", 1);
  EXPECT_NE(refusal(file(kHex + "\n", 0440)), "");
  unsetenv("CREDENTIALS_DIRECTORY");
}

TEST_F(KeyTest, AMissingKeyNamesTheCommandThatMakesIt) {
  EXPECT_TRUE(contains(refusal(folder_ / "tall.key"), "`gyrotwin key new --rig tall`"));
  EXPECT_NE(refusal(folder_), "");
}

TEST_F(KeyTest, CreatesPrivateFilesThatLoad) {
  const fs::path path = folder_ / "config" / "gyrotwin" / "rig.key";
  create_key(path);
  EXPECT_EQ(mode_of(path), 0600U);
  EXPECT_EQ(mode_of(path.parent_path()), 0700U);
  const Key key = load_key(path);
  create_key(path.parent_path() / "other.key");
  EXPECT_NE(load_key(path.parent_path() / "other.key"), key);

  // A key in use is never overwritten.
  EXPECT_THROW(create_key(path), Error);
  EXPECT_EQ(load_key(path), key);
}

TEST_F(KeyTest, CreatingSaysWhyItCannot) {
  EXPECT_THROW(create_key(file("a file, no folder") / "rig.key"), Error);
}

/// What `key check` finds wrong, all in one.
std::string wrongs(const std::vector<Finding>& findings) {
  std::string all;
  for (const Finding& finding : findings) all += finding.good ? "" : finding.text + '\n';
  return all;
}

class KeyCheckTest : public KeyTest {
 protected:
  void SetUp() override {
    KeyTest::SetUp();
    setenv("GYROTWIN_KEYS", folder_.c_str(), 1);
    rig_.name = "rig";
    rig_.file = "rig.toml";
  }
  Rig rig_{};
};

TEST_F(KeyCheckTest, FindsNothingWrongWithANewKey) {
  create_key(key_path("rig"));
  const auto findings = examine_key(rig_);
  EXPECT_EQ(wrongs(findings), "");
  EXPECT_EQ(findings.size(), 3u);
}

TEST_F(KeyCheckTest, FindsWhatIsWrongAndSaysWhatToDo) {
  EXPECT_TRUE(contains(wrongs(examine_key(rig_)), "`gyrotwin key new --rig rig`"));
  file("no key\n");
  EXPECT_TRUE(contains(wrongs(examine_key(rig_)), "expected 64 hex digits"));
  file(kHex + "\n", 0640);
  EXPECT_TRUE(contains(wrongs(examine_key(rig_)), "`chmod 600 "));
  file(kHex + "\n");
  EXPECT_EQ(wrongs(examine_key(rig_)), "");
  for (const mode_t mode : {0770U, 0707U, 0777U}) {
    chmod(folder_.c_str(), mode);
    EXPECT_TRUE(contains(wrongs(examine_key(rig_)), "`chmod 700 " + folder_.string() + "`"));
  }
  chmod(folder_.c_str(), 0755);  // names may be seen
  EXPECT_EQ(wrongs(examine_key(rig_)), "");
  rig_.network.sign = false;
  EXPECT_TRUE(contains(wrongs(examine_key(rig_)), "network.sign = false in rig.toml"));
}

TEST_F(KeyCheckTest, FindsAKeyOfAnotherUser) {
  const fs::path path = file(kHex + "\n");
  if (chown(path.c_str(), 65534, static_cast<gid_t>(-1)) != 0) GTEST_SKIP() << "not root";
  EXPECT_TRUE(contains(wrongs(examine_key(rig_)), "belongs to another user"));
}

TEST(KeyJudge, TellsThisKeyAnotherKeyAndSilenceApart) {
  EXPECT_TRUE(judge({.with_this_key = 7, .otherwise = 0, .seconds = 1.0}).good);
  EXPECT_TRUE(judge({.with_this_key = 0, .otherwise = 0, .seconds = 1.0}).good);
  for (const std::int64_t with_this_key : {0, 7}) {
    const Finding other = judge({with_this_key, 1, 1.0});
    EXPECT_FALSE(other.good);
    EXPECT_TRUE(contains(other.text, "`gyrotwin key show-id`"));
  }
}

TEST(RandomId, IsNonNegativeAndNeverTheSame) {
  std::set<std::int64_t> seen;
  std::int64_t all_bits = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t id = random_id();
    EXPECT_GE(id, 0);
    EXPECT_TRUE(seen.insert(id).second);
    all_bits |= id;
  }
  EXPECT_EQ(all_bits, INT64_MAX);
}

}  // namespace
}  // namespace gyrotwin
