#include "bridge/configure/protected_keys.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fieldcast::configure {

namespace {

struct ProtectedKey {
  const char* key;
  const char* why;
  bool (*same)(const BridgeSpec& present, const BridgeSpec& draft);
};

const std::string kNoStore;

const std::string& store_of(const BridgeSpec& spec) {
  return spec.store ? spec.store->address : kNoStore;
}

constexpr ProtectedKey kRows[] = {
    {"bridge", "the name by which stations find the bridge, and its standby group",
     [](const BridgeSpec& a, const BridgeSpec& b) {
       return a.name == b.name && a.standby == b.standby;
     }},
    {"dds", "how the bridge joins its domain, with its security folder",
     [](const BridgeSpec& a, const BridgeSpec& b) { return a.dds == b.dds; }},
    {"program", "listen addresses, certificates and secrets of programming",
     [](const BridgeSpec& a, const BridgeSpec& b) { return a.program == b.program; }},
    {"metrics", "a listen address of the bridge",
     [](const BridgeSpec& a, const BridgeSpec& b) { return a.metrics == b.metrics; }},
    {"configure", "whether this file may be changed from here",
     [](const BridgeSpec& a, const BridgeSpec& b) { return a.configure == b.configure; }},
    {"store.path", "the file of the store",
     [](const BridgeSpec& a, const BridgeSpec& b) { return store_of(a) == store_of(b); }},
    {"store.url", "the address of the store, which may contain a password",
     [](const BridgeSpec& a, const BridgeSpec& b) { return store_of(a) == store_of(b); }},
};

// Keys of a bus. A bus that is removed takes them with it.
struct ProtectedBusKey {
  const char* key;
  const char* why;
  bool (*same)(const BusSpec& present, const BusSpec& draft);
};

constexpr ProtectedBusKey kBusRows[] = {
    {"gateway", "a listen address of the bridge",
     [](const BusSpec& a, const BusSpec& b) {
       return !b.gateway || (a.gateway && a.gateway->listen == b.gateway->listen);
     }},
    {"capture", "a folder of the machine in which the bridge writes files",
     [](const BusSpec& a, const BusSpec& b) {
       return !b.capture || (a.capture && a.capture->folder == b.capture->folder);
     }},
};

constexpr const char* kHint = "an administrator changes it in the file itself";

const BusSpec* find_bus(const BridgeSpec& spec, const std::string& name) {
  const auto found = std::ranges::find(spec.buses, name, &BusSpec::name);
  return found == spec.buses.end() ? nullptr : &*found;
}

void add_lines(const config::Places& places, const std::string& path, const char* why,
               std::vector<ProtectedLine>& lines) {
  const auto found = places.lines(path);
  for (unsigned line = found ? found->first : 1; found && line <= found->last; ++line)
    lines.push_back({line, fmt::format("{}; {}", why, kHint)});
}

}  // namespace

std::vector<ProtectedLine> protected_lines(const BridgeSpec& spec, const config::Places& places) {
  std::vector<ProtectedLine> lines;
  for (const ProtectedKey& row : kRows) add_lines(places, row.key, row.why, lines);
  for (std::size_t i = 0; i < spec.buses.size(); ++i) {
    for (const ProtectedBusKey& row : kBusRows)
      add_lines(places, fmt::format("buses.{}.{}", i, row.key), row.why, lines);
  }
  std::ranges::sort(lines, {}, &ProtectedLine::line);
  return lines;
}

std::vector<std::string> changed_protected_keys(const BridgeSpec& present,
                                                const BridgeSpec& draft) {
  std::vector<std::string> changed;
  for (const ProtectedKey& row : kRows) {
    if (!row.same(present, draft))
      changed.push_back(fmt::format("{}: {}; {}", row.key, row.why, kHint));
  }
  for (const BusSpec& bus : draft.buses) {
    const BusSpec* const old = find_bus(present, bus.name);
    for (const ProtectedBusKey& row : kBusRows) {
      if (!row.same(old == nullptr ? BusSpec{} : *old, bus))
        changed.push_back(fmt::format("{} of bus {}: {}; {}", row.key, bus.name, row.why, kHint));
    }
  }
  return changed;
}

}  // namespace fieldcast::configure
