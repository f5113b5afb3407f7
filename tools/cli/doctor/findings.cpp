#include "tools/cli/doctor/findings.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/view/status/status_words.hpp"

namespace fieldcast::cli {

namespace {

using Findings = std::vector<Finding>;

constexpr std::uint64_t kMegabyte = 1'000'000;
constexpr std::uint64_t kDiskLow = 1'000 * kMegabyte;
constexpr std::uint64_t kDiskFull = 50 * kMegabyte;  // SQLite soon refuses to write

void look_at_receive_buffer(const MachineFacts& facts, Findings& found) {
  if (!facts.receive_buffer_limit) return;
  const std::uint64_t limit = *facts.receive_buffer_limit, asked = facts.receive_buffer_asked;
  Finding finding{
      Severity::kOk, "receive buffer", "net.core.rmem_max",
      fmt::format("{} KiB for a socket, {} KiB are asked for", limit / 1024, asked / 1024), ""};
  if (limit < asked) {
    finding.severity = Severity::kAdvice;
    finding.what += ": bursts of many channels get lost and are sent again";
    finding.remedy = fmt::format(
        "sysctl -w net.core.rmem_max={0}; to keep it: echo net.core.rmem_max={0} > "
        "/etc/sysctl.d/60-fieldcast.conf",
        asked);
  }
  found.push_back(finding);
}

void look_at_adapter(const AdapterFacts& adapter, Findings& found) {
  const std::string driver = adapter.driver.empty() ? "an unknown driver" : adapter.driver;
  Finding finding{Severity::kOk, "latency timer", adapter.name, "", ""};
  if (!adapter.latency_timer) {
    finding.what = driver + ", which has none";
  } else {
    finding.what = fmt::format("{}, {} ms", driver, *adapter.latency_timer);
    if (*adapter.latency_timer > 1) {
      finding.severity = Severity::kAdvice;
      finding.what +=
          ": the end of every response may wait so long in it, unless low-latency of the port is "
          "true";
      finding.remedy = "echo 1 > " + adapter.latency_file;
    }
  }
  found.push_back(finding);
}

void look_at_port(const SerialPortFacts& port, Findings& found) {
  Finding finding{Severity::kOk, "serial port", port.path, "bus " + port.bus + " may open it", ""};
  if (!port.there) {
    finding = {Severity::kPrevents, "serial port", port.path,
               fmt::format("bus {} has no such port: the bridge waits until it is there", port.bus),
               "plug the adapter in, or name its port: ls /dev/serial/by-id"};
  } else if (!port.readable_and_writable) {
    const std::string group = port.group.empty() ? "dialout" : port.group;
    finding = {Severity::kPrevents, "serial port", port.path,
               fmt::format("bus {} needs it, and {} may not open it", port.bus,
                           port.user.empty() ? "the current user" : "the user " + port.user),
               fmt::format("usermod -aG {} {}, the user that runs the bridge; then log in again",
                           group, port.user.empty() ? "USER" : port.user)};
  }
  found.push_back(finding);
}

void look_at_clock(const MachineFacts& facts, Findings& found) {
  if (!facts.clock_synchronised) return;
  Finding finding{Severity::kOk, "clock", "", "synchronised", ""};
  if (!*facts.clock_synchronised) {
    finding = {Severity::kAdvice, "clock", "",
               "not synchronised: commands from other hosts are refused or come again when clocks "
               "differ, and times of samples cannot be compared",
               "timedatectl set-ntp true, or chrony"};
  }
  found.push_back(finding);
}

void look_at_bridge_clocks(const MachineFacts& facts, Findings& found) {
  if (!facts.clocks_unknown.empty())
    found.push_back(
        {Severity::kOk, "clock", "", "not compared with bridges: " + facts.clocks_unknown, ""});
  for (const ClockFacts& clock : facts.clocks) {
    Finding finding{Severity::kOk, "clock", "bridge " + clock.bridge,
                    clock_words(clock.bridge, clock.ahead), ""};
    if (!clocks_agree(clock.ahead)) {
      const UtcTime there{clock.here.nanoseconds - clock.ahead.count()};
      finding.severity = Severity::kAdvice;
      finding.what += fmt::format(" (here {}, there {})", time_text(clock.here, Zone::kUtc),
                                  time_text(there, Zone::kUtc));
      finding.remedy = "timedatectl set-ntp true on both machines, or chrony";
    }
    found.push_back(finding);
  }
}

void look_at_interface(const InterfaceFacts& interface, bool discovery_server, Findings& found) {
  const std::string check = "discovery";
  if (interface.name.empty()) {
    found.push_back({Severity::kPrevents, check, interface.address,
                     "no interface of this machine has the address",
                     "dds: interfaces: of the configuration; ip -4 address lists what there is"});
  } else if (interface.multicast || discovery_server) {
    found.push_back({Severity::kOk, check, interface.address,
                     interface.name + (interface.loopback ? ", this machine alone"
                                       : discovery_server ? ", by a discovery server"
                                                          : ", by multicast"),
                     ""});
  } else {
    found.push_back({Severity::kPrevents, check, interface.address,
                     fmt::format("{} has no multicast, and no discovery server is named: nobody "
                                 "finds the bridge",
                                 interface.name),
                     interface.loopback
                         ? "dds: discovery-server: HOST:PORT"
                         : fmt::format("dds: discovery-server: HOST:PORT, or ip link set {} "
                                       "multicast on",
                                       interface.name)});
  }
}

void look_at_disk(const MachineFacts& facts, Findings& found) {
  if (!facts.disk) return;
  if (!facts.disk->folder_there) {
    found.push_back(
        {Severity::kPrevents, "disk", facts.disk->path,
         "the folder of the store is missing: nothing is stored, and commands are refused",
         fmt::format("mkdir -p {}, with the user that runs the bridge as its owner; the "
                     "service makes /var/lib/fieldcast when it starts",
                     facts.disk->folder)});
    return;
  }
  const std::uint64_t free = facts.disk->free_bytes;
  Finding finding{Severity::kOk, "disk", facts.disk->path,
                  fmt::format("{} MB free for the store", free / kMegabyte), ""};
  if (free < kDiskLow) {
    finding.severity = free < kDiskFull ? Severity::kPrevents : Severity::kAdvice;
    finding.remedy = "keep: and max-size: of the store bound it; or another disk";
  }
  found.push_back(finding);
}

void look_at_capture(const CaptureRemark& capture, Findings& found) {
  found.push_back({Severity::kAdvice, "capture", capture.folder,
                   fmt::format("bus {}: {}", capture.bus, capture.what), capture.remedy});
}

void look_at_profile(const MachineFacts& facts, Findings& found) {
  for (const ProfileLimit& limit : facts.profile_limits) {
    if (limit.profile != "fieldcast/Sample" && limit.profile != "fieldcast/Channel") continue;
    Finding finding{Severity::kOk, "profile", facts.profile_file,
                    fmt::format("{}: max_instances {} for {} channels", limit.profile,
                                limit.max_instances, facts.channels),
                    ""};
    // The library treats 0 and less as no limit.
    if (limit.max_instances > 0 &&
        static_cast<std::uint64_t>(limit.max_instances) < facts.channels) {
      finding.severity = Severity::kPrevents;
      finding.what += ": the others vanish without a word";
      finding.remedy = fmt::format("max_instances and max_samples of at least {}", facts.channels);
    }
    found.push_back(finding);
  }
}

}  // namespace

std::string_view severity_text(Severity severity) {
  constexpr std::string_view kTexts[] = {"ok", "advice", "prevents"};
  return kTexts[static_cast<std::size_t>(severity)];
}

std::vector<Finding> findings_of(const MachineFacts& facts) {
  Findings found;
  look_at_receive_buffer(facts, found);
  for (const AdapterFacts& adapter : facts.adapters) look_at_adapter(adapter, found);
  for (const SerialPortFacts& port : facts.ports) look_at_port(port, found);
  look_at_clock(facts, found);
  look_at_bridge_clocks(facts, found);
  for (const InterfaceFacts& interface : facts.interfaces)
    look_at_interface(interface, facts.discovery_server, found);
  look_at_disk(facts, found);
  for (const CaptureRemark& capture : facts.captures) look_at_capture(capture, found);
  look_at_profile(facts, found);
  return found;
}

Severity worst_of(const std::vector<Finding>& findings) {
  Severity worst = Severity::kOk;
  for (const Finding& finding : findings) worst = std::max(worst, finding.severity);
  return worst;
}

}  // namespace fieldcast::cli
