#include "config/declaration/declaration_keys.hpp"

#include <array>

namespace fieldcast::config {
namespace {

constexpr std::string_view kDeclaration[] = {"summary",   "addresses", "encoding",   "order",
                                             "bit-order", "areas",     "operations", "errors"};
constexpr std::string_view kAddresses[] = {"from", "to"};
constexpr std::string_view kArea[] = {"name",   "item", "items", "record",
                                      "prefix", "base", "origin"};
constexpr std::string_view kOperation[] = {"name",  "read",    "write", "command",
                                           "count", "request", "answer"};
constexpr std::string_view kCount[] = {"from", "to"};
constexpr std::string_view kErrors[] = {"frame", "codes", "busy"};
constexpr std::string_view kField[] = {
    "name", "constant", "is",     "bytes", "bits",   "digits",    "as",  "order",
    "plus", "times",    "of",     "kind",  "over",   "on",        "off", "ok",
    "text", "variable", "signed", "fill",  "counts", "complement"};

}  // namespace

const KeyTable kDeclarationKeys{"declaration", "a declared protocol", kDeclaration};
const KeyTable kAddressesKeys{"addresses", "'addresses'", kAddresses};
const KeyTable kAreaKeys{"area", "an area", kArea};
const KeyTable kOperationKeys{"operation", "an operation", kOperation};
const KeyTable kCountKeys{"count", "'count'", kCount};
const KeyTable kErrorsKeys{"errors", "'errors'", kErrors};
const KeyTable kFieldKeys{"field", "a field", kField};

std::span<const KeyTable* const> declaration_key_tables() {
  static constexpr std::array kTables{&kDeclarationKeys, &kAddressesKeys, &kAreaKeys,
                                      &kOperationKeys,   &kCountKeys,     &kErrorsKeys,
                                      &kFieldKeys};
  return kTables;
}

}  // namespace fieldcast::config
