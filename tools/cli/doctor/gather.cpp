#include "tools/cli/doctor/gather.hpp"

#include <arpa/inet.h>
#include <grp.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <pwd.h>
#include <sys/stat.h>
#include <sys/timex.h>
#include <tinyxml2.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <system_error>

#include "bridge/base/worker.hpp"
#include "bridge/dds/library/library.hpp"
#include "bridge/dds/transport/network_check.hpp"
#include "bridge/station/station.hpp"
#include "bridge/store/sql/sql.hpp"
#include "tools/cli/terminal/interrupt.hpp"

namespace fieldcast::cli {

void gather_clocks(const ConnectionOptions& options, MachineFacts& facts) {
  Interrupt interrupt;  // before DDS starts its threads
  const auto connection = resolve(options);
  if (!connection) {
    facts.clocks_unknown = connection.error();
    return;
  }
  BoundedQueue<ClockFacts> inbox{1024};
  std::map<std::string, ClockFacts> clocks;
  interrupt.on_raise([&inbox] { inbox.close(); });
  try {
    Station sites(connection->sites, "fieldcast-cli");
    sites.subscribe_bus_status([&inbox](const StationBusStatus& status) {
      if (status.clock_ahead) inbox.put_newest({status.bridge, *status.clock_ahead, utc_now()});
    });
    const Instant end = instant_now() + kListenForClocks;
    while (instant_now() < end && !inbox.closed()) {
      for (const ClockFacts& heard : inbox.take_all(to_steady(end))) clocks[heard.bridge] = heard;
    }
  } catch (const DdsError& error) { facts.clocks_unknown = error.what(); }
  interrupt.on_raise({});
  for (const auto& [bridge, clock] : clocks) facts.clocks.push_back(clock);
}

namespace {

namespace fs = std::filesystem;

class Machine {
 public:
  explicit Machine(fs::path root) : root_(std::move(root)) {}

  [[nodiscard]] bool is_this_one() const { return root_ == "/"; }
  // Path of a file below the root: "/sys/..".
  [[nodiscard]] fs::path at(const fs::path& path) const { return root_ / path.relative_path(); }

  [[nodiscard]] std::optional<std::int64_t> number_in(const fs::path& path) const {
    std::ifstream file(at(path));
    std::int64_t number = 0;
    if (!(file >> number)) return std::nullopt;
    return number;
  }
  [[nodiscard]] bool has(const fs::path& path) const {
    std::error_code ignored;
    return fs::exists(at(path), ignored);
  }

 private:
  fs::path root_;
};

std::vector<AdapterFacts> adapters_of(const Machine& machine) {
  const fs::path devices = "/sys/bus/usb-serial/devices";
  std::vector<AdapterFacts> adapters;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(machine.at(devices), none)) {
    AdapterFacts adapter;
    adapter.name = entry.path().filename();
    const fs::path driver = fs::read_symlink(entry.path() / "driver", none);
    if (!none) adapter.driver = driver.filename();
    const fs::path timer = devices / adapter.name / "latency_timer";
    if (const auto ms = machine.number_in(timer)) {
      adapter.latency_timer = static_cast<int>(*ms);
      adapter.latency_file = timer;
    }
    adapters.push_back(std::move(adapter));
  }
  std::ranges::sort(adapters, {}, &AdapterFacts::name);
  return adapters;
}

constexpr const char* kServiceUser = "fieldcast";

// Whether the user of the packaged service may read and write the file. Empty without this user.
// NOLINTBEGIN(concurrency-mt-unsafe): the command has one thread
std::optional<bool> service_may_use(const Machine& machine, const struct stat& status) {
  const auto open = [&](const char* path) {
    return std::unique_ptr<FILE, int (*)(FILE*)>(std::fopen(machine.at(path).c_str(), "re"),
                                                 [](FILE* file) { return std::fclose(file); });
  };
  const auto users = open("/etc/passwd"), groups = open("/etc/group");
  const passwd* user = nullptr;
  while (users && (user = ::fgetpwent(users.get())) && user->pw_name != std::string(kServiceUser)) {
  }
  if (user == nullptr) return std::nullopt;
  bool is_member = user->pw_gid == status.st_gid;
  while (const group* each = groups ? ::fgetgrent(groups.get()) : nullptr) {
    for (char** name = each->gr_mem; *name != nullptr; ++name)
      is_member |= each->gr_gid == status.st_gid && *name == std::string(kServiceUser);
  }
  const bool is_owner = user->pw_uid == status.st_uid;
  return ((status.st_mode >> (is_owner ? 6 : is_member ? 3 : 0)) & 6) == 6;
}
// NOLINTEND(concurrency-mt-unsafe)

SerialPortFacts port_facts(const Machine& machine, const std::string& bus,
                           const std::string& path) {
  SerialPortFacts facts{.bus = bus, .path = path};
  const std::string real = machine.at(path);
  struct stat status {};
  facts.there = stat(real.c_str(), &status) == 0;
  if (!facts.there) return facts;
  facts.readable_and_writable = access(real.c_str(), R_OK | W_OK) == 0;
  // With sudo, the current user is not that of the bridge.
  const bool is_other = ::getuid() == 0 || !machine.is_this_one();
  if (const auto may = is_other ? service_may_use(machine, status) : std::nullopt) {
    facts.readable_and_writable = *may;
    facts.user = kServiceUser;
  }
  // NOLINTNEXTLINE(concurrency-mt-unsafe): the command has one thread
  if (const group* owner = getgrgid(status.st_gid)) facts.group = owner->gr_name;
  return facts;
}

// The file of systemd's time service, or else the kernel's flag, which every service sets.
std::optional<bool> is_synchronised(const Machine& machine) {
  if (machine.has("/run/systemd/timesync/synchronized")) return true;
  if (!machine.is_this_one()) return std::nullopt;
  timex state{};
  if (adjtimex(&state) < 0) return std::nullopt;
  return (state.status & STA_UNSYNC) == 0;
}

std::vector<InterfaceFacts> interface_facts(const std::vector<std::string>& addresses) {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, freeifaddrs);
  std::vector<InterfaceFacts> all;
  for (const std::string& address : addresses) {
    InterfaceFacts facts{.address = address};
    in_addr wanted{};
    if (inet_pton(AF_INET, address.c_str(), &wanted) != 1) continue;
    for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
      if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET ||
          reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr.s_addr != wanted.s_addr)
        continue;
      facts.name = one->ifa_name;
      facts.loopback = (one->ifa_flags & IFF_LOOPBACK) != 0;
    }
    facts.multicast = !facts.name.empty() && !multicast_fault(address);
    all.push_back(facts);
  }
  return all;
}

std::optional<DiskFacts> disk_facts(const StoreSpec& store) {
  if (StoreAddress(store.address).is_server()) return std::nullopt;
  const fs::path folder = fs::absolute(store.address).parent_path();
  std::error_code fault;
  if (!fs::exists(folder, fault) && !fault) return DiskFacts{store.address, folder, false, 0};
  const fs::space_info space = fs::space(folder, fault);
  if (fault) return std::nullopt;
  return DiskFacts{store.address, folder, true, space.available};
}

// The library's limit if a profile sets none.
constexpr std::int64_t kLibraryInstances = 10;

std::vector<ProfileLimit> profile_limits(const std::string& file) {
  tinyxml2::XMLDocument document;
  if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) return {};
  tinyxml2::XMLHandle root(document.RootElement());
  const tinyxml2::XMLElement* profiles = root.ToElement();
  if (profiles != nullptr && std::string_view(profiles->Name()) == "dds")
    profiles = root.FirstChildElement("profiles").ToElement();
  if (profiles == nullptr) return {};
  std::vector<ProfileLimit> limits;
  for (const auto* one = profiles->FirstChildElement(); one; one = one->NextSiblingElement()) {
    const std::string_view kind = one->Name();
    if (kind != "data_reader" && kind != "data_writer") continue;
    const char* name = one->Attribute("profile_name");
    ProfileLimit limit{name == nullptr ? "" : name, kLibraryInstances};
    auto* inside = const_cast<tinyxml2::XMLElement*>(one);
    if (const auto* number = tinyxml2::XMLHandle(inside)
                                 .FirstChildElement("topic")
                                 .FirstChildElement("resourceLimitsQos")
                                 .FirstChildElement("max_instances")
                                 .ToElement())
      limit.max_instances = number->Int64Text(kLibraryInstances);
    limits.push_back(std::move(limit));
  }
  return limits;
}

void add_configuration(const Machine& machine, const BridgeSpec& spec, MachineFacts& facts) {
  for (const BusSpec& bus : spec.buses) {
    if (const auto* port = std::get_if<SerialPortSpec>(&bus.port))
      facts.ports.push_back(port_facts(machine, bus.name, port->path));
    for (const DeviceSpec& device : bus.devices) facts.channels += device.channels.size();
  }
  if (machine.is_this_one()) facts.interfaces = interface_facts(spec.dds.interfaces);
  facts.discovery_server = !spec.dds.discovery_servers.empty();
  if (machine.is_this_one()) facts.captures = capture_remarks(spec);
  if (spec.store && machine.is_this_one()) facts.disk = disk_facts(*spec.store);
  if (spec.dds.profile) {
    facts.profile_file = *spec.dds.profile;
    facts.profile_limits = profile_limits(facts.profile_file);
  }
}

}  // namespace

MachineFacts gather_facts(const fs::path& root, const BridgeSpec* spec) {
  const Machine machine(root);
  MachineFacts facts;
  facts.receive_buffer_asked = kReceiveBuffer;
  if (const auto limit = machine.number_in("/proc/sys/net/core/rmem_max"))
    facts.receive_buffer_limit = static_cast<std::uint64_t>(*limit);
  facts.adapters = adapters_of(machine);
  facts.clock_synchronised = is_synchronised(machine);
  if (spec != nullptr) add_configuration(machine, *spec, facts);
  return facts;
}

}  // namespace fieldcast::cli
