#include "tools/forward/settings/outlet_sections.hpp"

#include <fmt/format.h>

#include "tools/forward/settings/jetstream_keys.hpp"
#include "tools/forward/settings/postgresql_keys.hpp"

namespace fieldcast::forward {

namespace {

constexpr OutletSection kSections[] = {
    {"jetstream", read_jetstream, document_jetstream},
    {"postgresql", read_postgresql, document_postgresql},
};

}  // namespace

std::span<const OutletSection> outlet_sections() { return kSections; }

OutletSpec read_outlet(config::MapReader& file, config::Library& library) {
  OutletSpec spec;
  const OutletSection* chosen = nullptr;
  for (const OutletSection& section : kSections) {
    const config::Node* node = file.find(section.name);
    if (node == nullptr) continue;
    if (chosen != nullptr) {
      file.fault(section.name, fmt::format("'{}' beside '{}'", section.name, chosen->name),
                 "one engine; run a second forwarder with its own queue for the second engine");
      continue;
    }
    chosen = &section;
    spec = section.read(file, *node, library);
  }
  return spec;
}

}  // namespace fieldcast::forward
