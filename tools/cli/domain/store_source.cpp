#include "tools/cli/domain/store_source.hpp"

#include "config/loader/loader.hpp"

namespace fieldcast::cli {

void add_store(CommandLine& line, StoreSource& source) {
  line.text("--config", source.config, "Look into the store of this configuration file")
      .existing_file();
  line.text("--store", source.store,
            "Look into this store: a file, or postgresql://USER@HOST/DATABASE");
}

tl::expected<StoreAddress, std::string> resolve(const StoreSource& source) {
  if (!source.store.empty()) return StoreAddress(source.store);
  if (source.config.empty())
    return tl::unexpected(
        std::string("which store? --config FILE with a 'store' section, or --store FILE"));
  const auto loaded = config::load_file(source.config);
  if (!loaded) return tl::unexpected(config::to_text(loaded.error()));
  if (!loaded->store)
    return tl::unexpected(source.config +
                          ": there is no 'store' section: the bridge stores nothing");
  return StoreAddress(loaded->store->address);
}

}  // namespace fieldcast::cli
