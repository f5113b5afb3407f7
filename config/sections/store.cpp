#include "config/sections/store.hpp"

#include <fmt/format.h>

#include <utility>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/bridge_keys.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::config {
namespace {

void read_patterns(MapReader& map, StoreSpec& spec) {
  const Node* node = map.find("samples");
  if (node == nullptr) return;
  if (!is_list(*node, "samples", 0, kMaxPatterns,
               fmt::format("a list of up to {} patterns such as press-shop/*/oil-*", kMaxPatterns),
               map.faults(),
               node->kind == Kind::kScalar ? fmt::format("[\"{}\"]", node->text) : ""))
    return;
  spec.samples.clear();
  for (const Node* item : node->items) {
    const std::string* text =
        scalar_of(*item, "a pattern of samples", "BUS/DEVICE/CHANNEL with *", map.faults());
    if (text == nullptr) continue;
    if (const auto pattern = Pattern::parse(*text); !pattern) {
      map.faults().add(item->position, "samples: " + pattern.error(), "BUS/DEVICE/CHANNEL with *");
    }
    spec.samples.push_back(*text);
  }
}

// Faults do not quote the URL, as it may contain a password.
void read_url(MapReader& map, StoreSpec& spec) {
  if (!map.read("url", spec.address, TextRule{kMaxPath})) return;
  if (!spec.address.starts_with("postgresql://") && !spec.address.starts_with("postgres://")) {
    map.fault("url", "url of the store is no connection string of PostgreSQL",
              "postgresql://USER@HOST:PORT/DATABASE");
  }
}

}  // namespace

std::optional<Duration> KeepRule::operator()(const Node& node, std::string_view key,
                                             FaultList& faults) const {
  if (node.kind == Kind::kScalar && node.text == "forever") return Duration{};
  return DurationRule{kMinKeep, kMaxKeep, ", or forever"}(node, key, faults);
}
std::string KeepRule::schema() const {
  return R"({ "type": "string", "pattern": "^([0-9]+(\\.[0-9]+)?(us|ms|s|m|min|h|d)|forever)$" })";
}
std::string KeepRule::form() const {
  return DurationRule{kMinKeep, kMaxKeep}.form() + ", or `forever`";
}

void read_store(MapReader& bridge, std::optional<StoreSpec>& spec) {
  const Node* node = bridge.find("store");
  if (node == nullptr) return;
  MapReader map(*node, store_rows(), bridge.faults());
  StoreSpec store;
  std::string path;
  if (map.read("path", path, TextRule{kMaxPath}))
    store.address = resolve(*map.position().source, path);
  if (path.find("://") != std::string::npos) {
    map.fault("path", "path of the store is a connection string", "a file, or the string as url");
  }
  read_url(map, store);
  if (map.is_map() && map.has("path") == map.has("url")) {
    map.faults().add(map.position(),
                     map.has("path") ? "'path' and 'url' in one store" : "the store has no place",
                     "path: FILE, or url: postgresql://USER@HOST:PORT/DATABASE");
  }
  read_patterns(map, store);
  store_rows().read(map, store);
  spec = std::move(store);
}

}  // namespace fieldcast::config
