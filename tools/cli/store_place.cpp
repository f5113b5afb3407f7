#include "tools/cli/store_place.hpp"

#include "config/loader.hpp"

namespace fieldcast::cli {

void add_store(CommandLine& line, StorePlace& place) {
  line.text("--config", place.config, "Look into the store of this configuration file")
      .existing_file();
  line.text("--store", place.store,
            "Look into this store: a file, or postgresql://USER@HOST/DATABASE");
}

tl::expected<StoreAddress, std::string> resolve(const StorePlace& place) {
  if (!place.store.empty()) return StoreAddress(place.store);
  if (place.config.empty())
    return tl::unexpected(
        std::string("which store? --config FILE with a 'store' section, or --store FILE"));
  const auto loaded = config::load_file(place.config);
  if (!loaded) return tl::unexpected(config::to_text(loaded.error()));
  if (!loaded->store)
    return tl::unexpected(place.config +
                          ": there is no 'store' section: the bridge stores nothing");
  return StoreAddress(loaded->store->address);
}

}  // namespace fieldcast::cli
