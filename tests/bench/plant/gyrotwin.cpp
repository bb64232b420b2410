// The model beside its peers.
#include "tests/bench/plant/peer.hpp"

namespace gyrotwin::bench {

namespace {

class Gyrotwin : public Peer {
 public:
  Gyrotwin(std::string name, model::Machine machine)
      : name_(std::move(name)), machine_(std::move(machine)) {}

  std::string name() const override { return name_; }
  void load(const std::vector<Sample>& samples) override {
    samples_.assign(samples.begin(), samples.end());
  }
  void evaluate(std::size_t i) override {
    found_ = machine_.acceleration(samples_[i].state, samples_[i].input);
  }
  model::Coordinates acceleration() const override { return found_; }

 private:
  std::string name_;
  model::Machine machine_;
  std::vector<Sample> samples_;
  model::Coordinates found_;
};

}  // namespace

std::unique_ptr<Peer> gyrotwin_peer(const Rig& rig) {
  Rig steady = rig;
  steady.rotor_drive.reset();
  return std::make_unique<Gyrotwin>("gyrotwin", steady.build_machine());
}

std::unique_ptr<Peer> gyrotwin_with_rotor_drives(const Rig& rig) {
  return std::make_unique<Gyrotwin>("gyrotwin with rotor drives", rig.build_machine());
}

}  // namespace gyrotwin::bench
