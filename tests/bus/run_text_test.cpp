// Runs of a bus engine with simulated devices, as texts: runs/NAME.txt has a configuration, and
// what happens, each with the actions of the engine from then on. Times in ms since the start.
#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "config/loader/loader.hpp"
#include "tests/plan/loaded_bus.hpp"
#include "tests/support/golden.hpp"
#include "tools/sim/bus/virtual_bus.hpp"

namespace fieldcast::test {
namespace {

class SimulatedRun {
 public:
  explicit SimulatedRun(const std::string& head) : loaded_(head) {
    for (const DeviceSpec& device : loaded_.bus.devices) {
      for (const ChannelSpec& channel : device.channels) {
        names_.push_back(device.name + '/' + channel.name);
        channels_.push_back(channel);
      }
    }
  }

  // Before the first run:
  //   bytes       also shows what is sent and received
  //   fault NAME delay 3ms | silent 1s..2s | refuses AREA:FROM..TO CODE | late 1s | loses |
  //     garbles | truncates | doubles 5ms
  //   fault line echo
  // run 300ms     shows every action
  // count 10s     shows only how often each channel was good, and its longest gap
  // command w1 write plc/a = 5 [verify] [expires 2s] [by NAME], command r1 read plc/a
  // interest plc/a 1s | interest plc/a none | unplug | plug | lease | release | stop | trace
  // above 100 | report | restart
  std::string respond(const std::string& line) {
    const auto words = words_of(line);
    const std::string& event = words[0];
    out_.clear();
    show_ = event != "count";
    if (event == "fault") return fault(words);
    if (event == "bytes") {
      bytes_ = true;
      return {};
    }
    if (event == "run" || event == "count") return run(duration_of(words[1]));
    if (event == "report") return report();
    if (event == "command")
      bus().feed(CommandArrived{command(words)});
    else if (event == "interest")
      interest(words);
    else if (event == "unplug")
      bus().unplug();
    else if (event == "plug")
      bus().plug();
    else if (event == "lease")
      bus().feed(LeaseBegan{"engineer"});
    else if (event == "release")
      bus().feed(LeaseEnded{});
    else if (event == "stop")
      bus().feed(StopRequested{});
    else if (event == "above")
      bus().feed(CountAbove{std::stoull(words[1])});
    else if (event == "trace")
      bus().engine().set_trace(true);
    else if (event == "restart")
      bus().replace_engine(loaded_.bus, duration_of(words[1]));
    else
      return " !! unknown: " + line + '\n';
    return out_;
  }

 private:
  struct Seen {
    std::uint64_t good = 0, bad = 0;
    std::optional<Instant> last;
    Duration longest{};
  };

  sim::VirtualBus& bus() {
    if (!bus_) {
      seen_.resize(names_.size());
      bus_ = std::make_unique<sim::VirtualBus>(loaded_.bus, faults_, 1,
                                               [this](const Action& action) { see(action); });
      bus_->on_received = [this](ByteView bytes) {
        if (show_ && bytes_) out_ += "      << " + to_hex(bytes) + '\n';
      };
    }
    return *bus_;
  }
  std::string fault(const std::vector<std::string>& words) {
    if (words[1] == "line") {
      faults_.echo = true;
      return {};
    }
    sim::DeviceFaults& faults = faults_.devices[words[1]];
    if (words[2] == "delay")
      faults.delay.base = duration_of(words[3]);
    else if (words[2] == "loses")
      faults.loss = 1;
    else if (words[2] == "late")
      faults.late_probability = 1, faults.late = duration_of(words[3]);
    else if (words[2] == "garbles")
      faults.garble = 1;
    else if (words[2] == "truncates")
      faults.truncate = 1;
    else if (words[2] == "doubles")
      faults.doubled = 1, faults.doubled_after = duration_of(words[3]);
    else if (words[2] == "silent") {
      const auto dots = words[3].find("..");
      faults.silence.push_back(
          {duration_of(words[3].substr(0, dots)), duration_of(words[3].substr(dots + 2))});
    } else if (words[2] == "refuses") {
      const auto colon = words[3].find(':'), dots = words[3].find("..");
      faults.refused.push_back({words[3].substr(0, colon),
                                static_cast<std::uint32_t>(std::stoul(words[3].substr(colon + 1))),
                                static_cast<std::uint32_t>(std::stoul(words[3].substr(dots + 2))),
                                static_cast<std::uint8_t>(std::stoul(words[4]))});
    } else
      return " !! unknown fault\n";
    return {};
  }
  std::string run(Duration length) {
    sim::VirtualBus& bus = this->bus();
    for (Seen& seen : seen_) seen = {0, 0, seen.last, {}};
    sends_ = notices_ = 0;
    bus.run_until(bus.now() + length);
    if (show_) return out_;
    std::string text = out_ + "  " + std::to_string(sends_) + " requests, " +
                       std::to_string(notices_) + " notices\n";
    for (std::size_t channel = 0; channel < names_.size(); ++channel) {
      const Seen& seen = seen_[channel];
      text += "  " + names_[channel] + ": " + std::to_string(seen.good) + " good, " +
              std::to_string(seen.bad) + " bad, longest gap " + ms_text(seen.longest) + '\n';
    }
    return text;
  }
  Command command(const std::vector<std::string>& words) {
    Command made;
    made.requester = "test";
    made.request_id = ++commands_;
    ids_[made.request_id] = words[1];
    made.operation = words[2] == "write" ? Operation::kWrite : Operation::kAcquire;
    const auto slash = words[3].find('/');
    made.device = words[3].substr(0, slash);
    const std::string name = slash == std::string::npos ? "" : words[3].substr(slash + 1);
    Encoding encoding;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i] == words[3]) encoding = channels_[i].encoding;
    }
    for (std::size_t i = 4; i < words.size(); ++i) {
      if (words[i] == "=") {
        ++i;
        made.values.push_back(parse_value(encoding, words[i]).value_or(Value{words[i]}));
      } else if (words[i] == "as")
        encoding.type = *value_type_from(words[++i]);
      else if (words[i] == "mask")
        made.mask = static_cast<std::uint16_t>(std::stoul(words[++i], nullptr, 16));
      else if (words[i] == "verify")
        made.verify = true;
      else if (words[i] == "by")
        made.requester = words[++i];
      else if (words[i] == "gateway")
        made.gateway = true;
      else if (words[i] == "count")
        made.count = static_cast<std::uint32_t>(std::stoul(words[++i]));
      else if (words[i] == "age")
        made.max_age = duration_of(words[++i]);
      else if (words[i] == "expires")
        made.expires = bus().now() + duration_of(words[++i]);
    }
    if (name.find(':') != std::string::npos)
      made.target = AddressTarget{name, encoding};
    else
      made.target = ChannelTarget{name};
    return made;
  }
  void interest(const std::vector<std::string>& words) {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i] != words[1]) continue;
      const std::optional<Duration> refresh =
          words[2] == "none" ? std::nullopt : std::optional(duration_of(words[2]));
      bus().feed(InterestChanged{static_cast<ChannelIndex>(i), refresh});
    }
  }

  void line(const std::string& text) {
    out_ += "  " + ms_text((bus_ ? bus_->now() : Instant{}) - Instant{}) + ' ' + text + '\n';
  }
  void see(const Action& action) {
    std::visit([this](const auto& each) { seen(each); }, action);
  }
  void seen(const Send& send) {
    ++sends_;
    // The first request is sent before the constructor of the bus returns.
    if (!show_) return;
    if (bus_) line("> " + bus_->engine().request_text(send.bytes));
    if (bytes_ || !bus_) out_ += "      >> " + to_hex(send.bytes) + '\n';
  }
  void seen(const Publish& publish) {
    for (const Sample& sample : publish.samples) {
      Seen& seen = seen_[sample.channel];
      const bool good = sample.quality == Quality::kGood;
      ++(good ? seen.good : seen.bad);
      if (good) {
        if (seen.last) seen.longest = std::max(seen.longest, sample.acquired - *seen.last);
        seen.last = sample.acquired;
      }
      if (!show_) continue;
      line(names_[sample.channel] + " = " + to_text(sample.value) + ' ' +
           std::string(to_text(sample.quality)) +
           (sample.device_code != 0 ? " code " + std::to_string(sample.device_code) : "") + " #" +
           std::to_string(sample.sequence));
    }
  }
  void seen(const Promise& promise) {
    if (show_)
      line(names_[promise.channel] + " promised " + (promise.gap ? ms_text(*promise.gap) : "none"));
  }
  void seen(const Complete& complete) {
    const CommandResult& result = complete.result;
    std::string text =
        "result " + ids_[result.request_id] + ' ' + std::string(to_text(result.state));
    const std::size_t shown = result.values.size() > 20 ? 3 : result.values.size();
    for (std::size_t i = 0; i < shown; ++i) text += ' ' + to_text(result.values[i]);
    if (shown < result.values.size())
      text += " .. (" + std::to_string(result.values.size()) + " values)";
    if (result.device_code != 0) text += " code " + std::to_string(result.device_code);
    if (!result.reason.empty()) text += ": " + result.reason;
    line(text + ", after " + ms_text(result.completed - result.received));
  }
  void seen(const Reopen& reopen) { line("reopens: " + reopen.reason); }
  // The log counts repeated notices.
  void seen(const Notice& notice) {
    if (!show_) return void(++notices_);
    line("notice " + (notice.device.empty() ? "of the bus" : notice.device) + ": " + notice.text);
  }
  void seen(const Traced& traced) { line("trace " + traced.device + ": " + traced.text); }
  void seen(const SetTimer&) {}
  void seen(const MakePlan&) {}

  static std::string causes_text(const CauseCounters& causes) {
    std::string text;
    for (std::size_t i = 1; i < static_cast<std::size_t>(Cause::kCount); ++i) {
      const auto cause = static_cast<Cause>(i);
      if (causes[cause] != 0)
        text += ' ' + std::to_string(causes[cause]) + " x " + std::string(to_text(cause));
    }
    return text.empty() ? " none" : text;
  }
  std::string report() {
    const BusReport made = bus().engine().bus_report(bus().now());
    std::string text =
        "  bus " + std::string(to_text(made.state)) + ": load planned " +
        percent_text(made.planned_load) + ", measured " + percent_text(made.measured_load) +
        ", wire " + percent_text(made.utilisation) + ", stretch " + factor_text(made.stretch) +
        ", silence " + ms_text(made.silence) + '\n' + "    " + std::to_string(made.exchanges) +
        " exchanges, " + std::to_string(made.samples) + " samples, " +
        std::to_string(made.commands) + " commands, " + std::to_string(made.deadline_misses) +
        " late, " + std::to_string(made.bytes_sent) + '/' + std::to_string(made.bytes_received) +
        " bytes, " + std::to_string(made.reopened) +
        " times reopened\n    failures:" + causes_text(made.causes) +
        "; late because:" + causes_text(made.misses) + '\n';
    for (DeviceIndex device = 0; device < loaded_.bus.devices.size(); ++device) {
      const DeviceReport each = bus().engine().device_report(device, bus().now());
      text += "  " + loaded_.bus.devices[device].name + ' ' + std::string(to_text(each.state)) +
              ": " + std::to_string(each.exchanges) + " exchanges, " +
              std::to_string(each.failures) + " failed, " + std::to_string(each.retries) +
              " repeated, " + std::to_string(each.deadline_misses) + " late, response " +
              ms_text(each.response_time) + " +- " + ms_text(each.response_spread) + ", timeout " +
              ms_text(each.timeout) + ", pause " + ms_text(each.pause) +
              "\n    failures:" + causes_text(each.causes) + '\n';
      for (const AreaReport& area : each.areas) {
        text += "    " + area.area + ": response " + ms_text(area.response_time) +
                ", largest block " + std::to_string(area.largest_block) + ", longest " +
                std::to_string(area.longest_block) + '\n';
      }
      for (const std::string& refused : each.refused) text += "    refused " + refused + '\n';
      for (const std::string& gap : each.refused_gaps) text += "    gap " + gap + '\n';
    }
    return text;
  }

  LoadedBus loaded_;
  std::vector<std::string> names_;
  std::vector<ChannelSpec> channels_;
  sim::BusFaults faults_;
  std::vector<Seen> seen_;
  std::uint64_t sends_ = 0, notices_ = 0, commands_ = 0;
  std::map<std::uint64_t, std::string> ids_;
  bool show_ = true, bytes_ = false;
  std::string out_;
  std::unique_ptr<sim::VirtualBus> bus_;
};

class WrittenRun : public testing::TestWithParam<std::string> {};

TEST_P(WrittenRun, IsAsWritten) {
  expect_bus_responses<SimulatedRun>(FIELDCAST_RUNS "/" + GetParam() + ".txt");
}

INSTANTIATE_TEST_SUITE_P(Files, WrittenRun, testing::ValuesIn(golden_names(FIELDCAST_RUNS)),
                         golden_test_name);

}  // namespace
}  // namespace fieldcast::test
