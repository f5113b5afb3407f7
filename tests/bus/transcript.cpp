#include "tests/bus/transcript.hpp"

#include <charconv>
#include <cmath>
#include <sstream>
#include <vector>

#include "config/loader/loader.hpp"
#include "core/bus/bus_engine.hpp"

namespace fieldcast::test {
namespace {

std::optional<Duration> parse_instant(std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{}) return std::nullopt;
  const std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  if (unit.empty() && number == 0) return Duration::zero();
  const auto nanoseconds = [&](double scale) { return Duration{std::llround(number * scale)}; };
  if (unit == "us") return nanoseconds(1e3);
  if (unit == "ms") return nanoseconds(1e6);
  if (unit == "s") return nanoseconds(1e9);
  if (unit == "min") return nanoseconds(60e9);
  return std::nullopt;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

class Replay {
 public:
  explicit Replay(const BusSpec& bus) : bus_(bus), engine_(bus) {
    for (const DeviceSpec& device : bus.devices)
      for (const ChannelSpec& channel : device.channels)
        names_.push_back(device.name + '/' + channel.name);
  }

  void run_timers_until(Instant until) {
    while (timer_ < until) {
      const Instant at = timer_;
      timer_ = kNever;
      feed(TimerFired{}, at);
    }
  }
  // Base of a time by number of pluses: start, next request without a response, last event.
  Instant base(unsigned pluses) {
    if (pluses == 0) return Instant{};
    if (pluses == 2) return last_;
    for (int turns = 0; !unanswered_ && timer_ != kNever && turns < 1000; ++turns)
      run_timers_until(timer_ + Duration{1});
    unanswered_ = false;
    return sent_;
  }
  void event(const BusEvent& event, Instant at, const std::string& line) {
    out_ += line + '\n';
    last_ = at;
    feed(event, at);
  }
  void remark(const std::string& line) { out_ += line + '\n'; }
  void trace(const std::string& line) {
    engine_.set_trace(tracing_ = true);
    remark(line);
  }
  [[nodiscard]] std::string text() const { return out_; }
  [[nodiscard]] const BusSpec& bus() const { return bus_; }

 private:
  void feed(const BusEvent& event, Instant at) {
    Actions actions;
    engine_.on_event(event, at, actions);
    make_plans(engine_, at, actions);
    for (const Action& action : actions) std::visit([&](const auto& a) { tell(a, at); }, action);
  }
  void line(Instant at, const std::string& what) {
    std::string stamp = at == Instant{} ? "0" : to_text(at - Instant{});
    stamp.resize(std::max<std::size_t>(stamp.size() + 1, 10), ' ');
    out_ += stamp + what + '\n';
  }
  void tell(const Send& a, Instant at) {
    sent_ = at;
    unanswered_ = true;
    line(at, ">> " + to_hex(a.bytes));
    if (tracing_) line(at, "asks " + engine_.request_text(a.bytes));
  }
  void tell(const SetTimer& a, Instant) { timer_ = a.at; }
  void tell(const Publish& a, Instant at) {
    for (const Sample& s : a.samples) {
      std::string code = s.device_code ? " code " + std::to_string(s.device_code) : "";
      line(at, "sample " + names_[s.channel] + " = " + to_text(s.value) + ' ' +
                   std::string(to_text(s.quality)) + code);
    }
  }
  void tell(const Promise& a, Instant at) {
    line(at, "promise " + names_[a.channel] + ' ' + (a.gap ? to_text(*a.gap) : "none"));
  }
  void tell(const Complete& a, Instant at) {
    std::string text = "result c" + std::to_string(a.result.request_id) + ' ' +
                       std::string(to_text(a.result.state));
    for (const Value& value : a.result.values) text += ' ' + to_text(value);
    if (!a.result.reason.empty()) text += ": " + a.result.reason;
    line(at, text);
  }
  void tell(const Reopen& a, Instant at) { line(at, "reopen: " + a.reason); }
  void tell(const Notice& a, Instant at) {
    line(at, "notice " + (a.device.empty() ? bus_.name : a.device) + ": " + a.text);
  }
  void tell(const Traced& a, Instant at) { line(at, "traced " + a.device + ": " + a.text); }
  void tell(const MakePlan&, Instant) {}

  BusSpec bus_;
  BusEngine engine_;
  std::vector<std::string> names_;
  std::string out_;
  Instant timer_ = kNever;
  Instant sent_{};
  Instant last_{};
  bool unanswered_ = false, tracing_ = false;
};

// Example: "command c1 write press-1/setpoint = 5 verify expires 2s"
std::optional<Command> parse_command(const std::vector<std::string>& words, const BusSpec& bus,
                                     Instant now) {
  if (words.size() < 5 || words[2].size() < 2) return std::nullopt;
  Command command;
  command.requester = "test";
  command.request_id = std::stoull(words[2].substr(1));
  command.operation = words[3] == "write" ? Operation::kWrite : Operation::kAcquire;
  const auto slash = words[4].find('/');
  command.device = words[4].substr(0, slash);
  const std::string name = slash == std::string::npos ? "" : words[4].substr(slash + 1);
  Encoding encoding;
  const auto colon = name.find(':');
  if (colon != std::string::npos)
    command.target = AddressTarget{name, encoding};
  else
    command.target = ChannelTarget{name};
  for (const DeviceSpec& device : bus.devices)
    for (const ChannelSpec& channel : device.channels)
      if (device.name == command.device && channel.name == name) encoding = channel.encoding;
  for (std::size_t i = 5; i < words.size(); ++i) {
    if (words[i] == "=" && i + 1 < words.size()) {
      const auto value = parse_value(encoding, words[++i]);
      command.values.push_back(value ? *value : Value{words[i]});
    } else if (words[i] == "verify") {
      command.verify = true;
    } else if (words[i] == "expires" && i + 1 < words.size()) {
      const auto in = parse_instant(words[++i]);
      if (!in) return std::nullopt;
      command.expires = now + *in;
    } else {
      return std::nullopt;
    }
  }
  return command;
}

bool is_outcome(const std::string& word) {
  return word == ">>" || word == "sample" || word == "result" || word == "notice" ||
         word == "reopen:" || word == "promise" || word == "asks" || word == "traced";
}

void replay_line(Replay& replay, const std::string& line) {
  const auto words = words_of(line);
  if (words.empty() || words[0][0] == '#') return replay.remark(line);
  if (words.size() < 2) return replay.remark("!! no instant and event: " + line);
  if (is_outcome(words[1])) return;  // output of the engine
  const std::size_t pluses = words[0].find_first_not_of('+');
  const auto instant =
      parse_instant(std::string_view(words[0]).substr(std::min(pluses, words[0].size())));
  if (!instant || pluses > 2) return replay.remark("!! no instant: " + line);
  const Instant at = replay.base(static_cast<unsigned>(pluses)) + *instant;
  replay.run_timers_until(at);
  if (words[1] == "<<") {
    const auto bytes = from_hex(line.substr(line.find("<<") + 2));
    if (!bytes) return replay.remark("!! no bytes: " + line);
    return replay.event(Received{*bytes}, at, line);
  }
  if (words[1] == "trace") return replay.trace(line);
  if (words[1] == "opened") return replay.event(Opened{}, at, line);
  if (words[1] == "closed") return replay.event(Closed{"unplugged"}, at, line);
  if (words[1] == "leased") return replay.event(LeaseBegan{"engineer"}, at, line);
  if (words[1] == "released") return replay.event(LeaseEnded{}, at, line);
  if (words[1] == "stop") return replay.event(StopRequested{}, at, line);
  if (words[1] == "input" && words.size() == 5) {  // of another bus: "input 0 = 12.5"
    const InputSample sample{std::stoull(words[2]), std::stod(words[4]), Quality::kGood, 0, at};
    return replay.event(InputsArrived{{sample}}, at, line);
  }
  if (words[1] == "end" || words[1] == "lost") return replay.remark(line);
  if (words[1] == "command") {
    const auto command = parse_command(words, replay.bus(), at);
    if (!command) return replay.remark("!! no command: " + line);
    return replay.event(CommandArrived{*command}, at, line);
  }
  replay.remark("!! unknown event: " + line);
}

}  // namespace

std::string replay(const std::string& text) {
  const auto rule = text.find("---\n");
  if (rule == std::string::npos)
    return "!! a transcript begins with a configuration and a line of three hyphens\n";
  const std::string head = text.substr(0, rule + 4);
  const auto loaded = config::load_text(text.substr(0, rule), "transcript.yaml", {});
  if (!loaded) {
    std::string faults;
    for (const auto& fault : loaded.error()) faults += "!! " + to_text(fault) + '\n';
    return faults;
  }
  Replay replay(loaded->buses.front());
  std::istringstream lines(text.substr(rule + 4));
  for (std::string line; std::getline(lines, line);) replay_line(replay, line);
  return head + replay.text();
}

}  // namespace fieldcast::test
