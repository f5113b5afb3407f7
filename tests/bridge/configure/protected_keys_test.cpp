#include "bridge/configure/protected_keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bridge/configure/draft_check.hpp"

namespace fieldcast::configure {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kPlant = R"(bridge: b
dds:
  domain: 7
  interfaces: [127.0.0.1]
store: { path: s.db, keep: 3d }
buses:
  - name: line
    port: { tcp: "127.0.0.1:502" }
    protocol: modbus-tcp
    devices:
      - { name: d, address: 1, channels: [ { name: c, at: "holding:1", type: uint16 } ] }
)";

std::vector<std::string> changed(const std::string& from, const std::string& to) {
  std::string draft = kPlant;
  draft.replace(draft.find(from), from.size(), to);
  const Draft present = load_present(kPlant, "/nowhere/b.yaml");
  const Draft other = load_present(draft, "/nowhere/b.yaml");
  EXPECT_TRUE(other.loaded) << config::to_text(other.loaded.error());
  return changed_protected_keys(*present.loaded, *other.loaded);
}

TEST(ProtectedKeys, OrdinaryChangesAreAllowed) {
  EXPECT_THAT(changed("name: c,", "name: e,"), IsEmpty());
  EXPECT_THAT(changed("keep: 3d", "keep: 4d"), IsEmpty());
  EXPECT_THAT(changed("bridge: b\n", "bridge: b\nlog: { level: debug }\n"), IsEmpty());
}

TEST(ProtectedKeys, AddressesIdentityAndStoreAreNot) {
  EXPECT_THAT(changed("domain: 7", "domain: 8"), ElementsAre(HasSubstr("dds: ")));
  EXPECT_THAT(changed("bridge: b", "bridge: c"), ElementsAre(HasSubstr("bridge: ")));
  EXPECT_THAT(changed("s.db", "t.db"),
              ElementsAre(HasSubstr("store.path: "), HasSubstr("store.url: ")));
  EXPECT_THAT(changed("buses:", "metrics: { listen: 127.0.0.1:9464 }\nbuses:"),
              ElementsAre(HasSubstr("metrics: ")));
  EXPECT_THAT(changed("buses:", "configure: { allow: true }\nbuses:"),
              ElementsAre(HasSubstr("configure: ")));
}

TEST(ProtectedKeys, ANewGatewayIsNot) {
  EXPECT_THAT(
      changed("    devices:",
              "    gateway: { listen: \"0.0.0.0:5020\", clients: [10.0.0.0/8] }\n    devices:"),
      ElementsAre(HasSubstr("gateway of bus line")));
}

TEST(ProtectedKeys, LinesAreThoseOfTheKeys) {
  const Draft present = load_present(kPlant, "/nowhere/b.yaml");
  std::vector<unsigned> lines;
  for (const ProtectedLine& line : protected_lines(*present.loaded, present.places))
    lines.push_back(line.line);
  EXPECT_THAT(lines, ElementsAre(1, 2, 3, 4, 5));
}

}  // namespace
}  // namespace fieldcast::configure
