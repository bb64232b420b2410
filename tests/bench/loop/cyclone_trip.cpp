// Cyclone DDS with types of the same fields: best effort, the newest sample alone, a waitset; all
// else as it comes.
#include <dds/dds.h>

#include <stdexcept>
#include <string>

#include "loop.h"
#include "tests/bench/loop/trip.hpp"

namespace gyrotwin::bench {
namespace {

dds_entity_t checked(dds_entity_t entity) {
  if (entity < 0) throw std::runtime_error(std::string("Cyclone DDS: ") + dds_strretcode(entity));
  return entity;
}

/// A participant that writes one topic and reads another.
class Peer {
 public:
  struct Topic {
    const dds_topic_descriptor_t* type;
    const char* name;
  };
  static constexpr Topic kState{&loop_bench_State_desc, "LoopState"};
  static constexpr Topic kCommand{&loop_bench_Command_desc, "LoopCommand"};

  Peer(const Topic& written, const Topic& read)
      : participant_(checked(dds_create_participant(DDS_DOMAIN_DEFAULT, nullptr, nullptr))) {
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
    const auto topic = [&](const Topic& t) {
      return checked(dds_create_topic(participant_, t.type, t.name, qos, nullptr));
    };
    writer_ = checked(dds_create_writer(participant_, topic(written), qos, nullptr));
    reader_ = checked(dds_create_reader(participant_, topic(read), qos, nullptr));
    dds_delete_qos(qos);
    waitset_ = checked(dds_create_waitset(participant_));
    const dds_entity_t condition = checked(dds_create_readcondition(reader_, DDS_ANY_STATE));
    checked(dds_waitset_attach(waitset_, condition, condition));
  }
  ~Peer() { dds_delete(participant_); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  template <class Sample>
  void write(const Sample& sample) {
    dds_write(writer_, &sample);
  }

  /// @return whether there is a sample, within the patience
  template <class Sample>
  bool take(Sample& sample) {
    if (dds_waitset_wait(waitset_, nullptr, 0, DDS_MSECS(kPatienceMs)) <= 0) return false;
    void* into = &sample;
    dds_sample_info_t info;
    return dds_take(reader_, &into, &info, 1, 1) == 1 && info.valid_data;
  }

 private:
  dds_entity_t participant_, writer_ = 0, reader_ = 0, waitset_ = 0;
};

class DdsNear final : public Near {
 public:
  bool there_and_back() override {
    state_.header.count = ++sequence_;
    peer_.write(state_);
    while (command_.header.count != sequence_) {
      if (!peer_.take(command_)) return false;
    }
    return true;
  }

 private:
  Peer peer_{Peer::kState, Peer::kCommand};
  std::int64_t sequence_ = 0;
  loop_bench_State state_{};
  loop_bench_Command command_{};
};

class DdsFar final : public Far {
 public:
  void answer() override {
    if (!peer_.take(state_)) return;
    command_.header.count = state_.header.count;
    peer_.write(command_);
  }

 private:
  Peer peer_{Peer::kCommand, Peer::kState};
  loop_bench_State state_{};
  loop_bench_Command command_{};
};

}  // namespace

std::unique_ptr<Near> cyclone_near() { return std::make_unique<DdsNear>(); }
std::unique_ptr<Far> cyclone_far() { return std::make_unique<DdsFar>(); }

}  // namespace gyrotwin::bench
