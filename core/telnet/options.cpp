#include "core/telnet/options.hpp"

#include <algorithm>

namespace fieldcast::telnet {

const Options::State* Options::find(std::uint8_t option, End end) const {
  const auto known = std::find(kKnown.begin(), kKnown.end(), option);
  if (known == kKnown.end() || (option == kEcho && end != echo_)) return nullptr;
  return &states_[static_cast<std::size_t>(end)][static_cast<std::size_t>(known - kKnown.begin())];
}

bool Options::enabled(std::uint8_t option, End end) const {
  const State* state = find(option, end);
  return state != nullptr && *state == State::kOn;
}

bool Options::refused(std::uint8_t option, End end) const {
  const State* state = find(option, end);
  return state != nullptr && *state == State::kRefused;
}

void Options::request(std::uint8_t option, End end, Bytes& out) {
  auto* state = const_cast<State*>(find(option, end));
  if (state == nullptr || *state != State::kOff) return;
  *state = State::kRequested;
  append_request(out, {end == End::kHere ? Code::kWill : Code::kDo, option});
}

// RFC 1143, section 7. WILL and WONT concern the peer's end, DO and DONT this end.
void Options::on_request(const OptionRequest& received, Bytes& out) {
  const bool there = received.verb == Code::kWill || received.verb == Code::kWont;
  const bool enable = received.verb == Code::kWill || received.verb == Code::kDo;
  const Code yes = there ? Code::kDo : Code::kWill, no = there ? Code::kDont : Code::kWont;
  auto* state = const_cast<State*>(find(received.option, there ? End::kThere : End::kHere));
  if (state == nullptr) {
    if (enable) respond({no, received.option}, out);
    return;
  }
  const State before = *state;
  if (enable) {
    *state = State::kOn;
    if (before == State::kOff || before == State::kRefused) respond({yes, received.option}, out);
  } else if (before != State::kOff) {
    *state = State::kRefused;
    if (before == State::kOn) respond({no, received.option}, out);
  }
}

void Options::respond(const OptionRequest& response, Bytes& out) {
  if (++responses_ <= kMaxResponses) append_request(out, response);
}

}  // namespace fieldcast::telnet
