#include "config/sections/store.hpp"

#include <fmt/format.h>

#include <utility>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/bridge_keys.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::config {
namespace {

constexpr std::pair<std::string_view, std::int64_t> kUnits[] = {
    {"MB", 1'000'000}, {"GB", 1'000'000'000}, {"TB", 1'000'000'000'000}};

void read_patterns(MapReader& map, StoreSpec& spec) {
  const Node* node = map.find("samples");
  if (node == nullptr) return;
  if (node->kind != Kind::kList || node->items.size() > kMaxPatterns) {
    map.faults().add(
        node->position,
        "samples is " + (node->kind == Kind::kList ? "too long" : std::string(to_text(node->kind))),
        fmt::format("a list of up to {} patterns such as press-shop/*/oil-*", kMaxPatterns),
        node->kind == Kind::kScalar ? fmt::format("[\"{}\"]", node->text) : "");
    return;
  }
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
    map.faults().add(map.position_of("url"),
                     "url of the store is no connection string of PostgreSQL",
                     "postgresql://USER@HOST:PORT/DATABASE");
  }
}

}  // namespace

std::optional<std::int64_t> StoreSizeRule::operator()(const Node& node, std::string_view key,
                                                      FaultList& faults) const {
  static constexpr std::string_view kAllowed = "10MB to 1000TB, with MB, GB or TB";
  constexpr auto kMax = static_cast<std::int64_t>(kMaxStoreBytes);
  constexpr auto kMin = static_cast<std::int64_t>(kMinStoreBytes);
  const std::string* text = scalar_of(node, key, kAllowed, faults);
  if (text == nullptr) return std::nullopt;
  for (const auto& [unit, worth] : kUnits) {
    if (!text->ends_with(unit)) continue;
    const auto number = whole_from(std::string_view(*text).substr(0, text->size() - unit.size()));
    if (!number || *number < 0) continue;
    if (*number <= kMax / worth && *number * worth >= kMin) return *number * worth;
    faults.add(node.position, fmt::format("{} '{}' is out of range", key, *text),
               std::string(kAllowed));
    return std::nullopt;
  }
  faults.add(node.position, fmt::format("{} '{}' cannot be understood", key, *text),
             std::string(kAllowed));
  return std::nullopt;
}
std::string StoreSizeRule::schema() const {
  return R"({ "type": "string", "pattern": "^[0-9]+(MB|GB|TB)$" })";
}
std::string StoreSizeRule::form() const { return "10MB to 1000TB"; }

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
    map.faults().add(map.position_of("path"), "path of the store is a connection string",
                     "a file, or the string as url");
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
