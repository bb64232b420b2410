// Datagrams one by one: none out of order, none forgotten, none invented, whoever slept.
#include "services/runtime/inbox.hpp"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cstring>
#include <stdexcept>
#include <vector>

#include "services/runtime/descriptor.hpp"

namespace gyrotwin {
namespace {

constexpr std::int64_t kPatience = 5'000'000'000;  // [ns]

/// A socket that hears, and one that speaks to it, on the loopback interface.
class Pair {
 public:
  Pair() : ear_(::socket(AF_INET, SOCK_DGRAM, 0)), mouth_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    if (::bind(ear_.get(), generic, size) || ::getsockname(ear_.get(), generic, &size) ||
        ::connect(mouth_.get(), generic, size)) {
      throw std::runtime_error("no UDP on the loopback interface");
    }
  }
  int ear() const { return ear_.get(); }
  void say(int number) {
    ASSERT_EQ(::send(mouth_.get(), &number, sizeof number, 0), ssize_t{sizeof number});
  }

 private:
  Descriptor ear_, mouth_;
};

int number_in(const Datagram& datagram) {
  int number = -1;
  EXPECT_EQ(datagram.bytes.size(), sizeof number);
  std::memcpy(&number, datagram.bytes.data(), sizeof number);
  return number;
}

/// All that next() has until it has nothing.
std::vector<int> all(Inbox& inbox) {
  std::vector<int> numbers;
  while (const auto datagram = inbox.next()) numbers.push_back(number_in(*datagram));
  return numbers;
}

std::vector<int> counted(int from, int to) {
  std::vector<int> numbers;
  for (int i = from; i < to; ++i) numbers.push_back(i);
  return numbers;
}

TEST(Inbox, HasAllThatWaitsInOrder) {
  for (const int count : {1, 2, 64}) {
    Pair pair;
    Inbox inbox(pair.ear());
    for (int i = 0; i < count; ++i) pair.say(i);
    ASSERT_TRUE(inbox.wait(kPatience));
    EXPECT_EQ(all(inbox), counted(0, count));
    EXPECT_FALSE(inbox.next());
  }
}

TEST(Inbox, HasWithoutWaitingToo) {
  Pair pair;
  Inbox inbox(pair.ear());
  EXPECT_FALSE(inbox.next());
  for (int i = 0; i < 12; ++i) pair.say(i);
  EXPECT_EQ(all(inbox), counted(0, 12));
}

TEST(Inbox, HearsWhatComesInBetween) {
  Pair pair;
  Inbox inbox(pair.ear());
  std::vector<int> heard;
  int next = 0;
  for (int round = 0; round < 50; ++round) {
    for (int i = 0; i < 1 + round % 11; ++i) pair.say(next++);
    ASSERT_TRUE(inbox.wait(kPatience));
    heard.push_back(number_in(*inbox.next()));
    pair.say(next++);
    for (const int number : all(inbox)) heard.push_back(number);
  }
  while (inbox.wait(0)) {
    for (const int number : all(inbox)) heard.push_back(number);
  }
  EXPECT_EQ(heard, counted(0, next));
}

/// Who sleeps on the descriptor would not be woken for these.
TEST(Inbox, SaysWhatItHolds) {
  Pair pair;
  Inbox inbox(pair.ear());
  EXPECT_FALSE(inbox.holds());
  for (int i = 0; i < 3; ++i) pair.say(i);
  ASSERT_TRUE(inbox.wait(kPatience));
  EXPECT_TRUE(inbox.holds());
  EXPECT_TRUE(inbox.wait(0));
  EXPECT_EQ(all(inbox), counted(0, 3));
  EXPECT_FALSE(inbox.holds());
  EXPECT_FALSE(inbox.wait(0));
}

}  // namespace
}  // namespace gyrotwin
