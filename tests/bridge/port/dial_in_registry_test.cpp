#include "bridge/port/dial_in_registry.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <map>
#include <string>

namespace fieldcast {
namespace {

FileDescriptor some_socket() { return FileDescriptor(::socket(AF_INET, SOCK_STREAM, 0)); }

TEST(DialInRegistry, ABusThatEndsLateTakesNothingFromTheNextOne) {
  DialInRegistry registry;
  const auto first = registry.expect("17");
  int delivered = 0;
  const auto old = registry.claim("17", [](FileDescriptor) { ADD_FAILURE() << "to the old bus"; });
  const auto second = registry.expect("17");
  const auto claim = registry.claim("17", [&](FileDescriptor) { ++delivered; });
  registry.release("17", old);
  registry.forget("17", first);
  EXPECT_FALSE(registry.offer("17", some_socket()));
  EXPECT_EQ(delivered, 1);
  registry.release("17", claim);
  registry.forget("17", second);
  EXPECT_TRUE(registry.offer("17", some_socket()));
}

TEST(DialInRegistry, AnOlderConnectionNeverReplacesANewerOne) {
  DialInRegistry registry;
  (void)registry.expect("17");
  FileDescriptor newer = some_socket();
  const int wanted = newer.get();
  EXPECT_FALSE(registry.offer("17", some_socket()));
  EXPECT_FALSE(registry.offer("17", std::move(newer)));
  registry.pass_on("17", some_socket());  // its bus, or who kept it, comes late
  int given = -1;
  (void)registry.claim("17", [&](FileDescriptor socket) { given = socket.get(); });
  EXPECT_EQ(given, wanted);
}

TEST(DialInRegistry, AModuleThatWaitsForABusThatEndsIsKeptAndGivenToTheNextOne) {
  DialInRegistry registry;
  std::map<std::string, FileDescriptor> kept;
  registry.set_keeper(
      {[&](const std::string& number, FileDescriptor socket) { kept[number] = std::move(socket); },
       [&](const std::string& number) {
         const auto found = kept.find(number);
         return found == kept.end() ? FileDescriptor{} : std::move(found->second);
       }});
  const auto first = registry.expect("17");
  EXPECT_FALSE(registry.offer("17", some_socket()));
  registry.forget("17", first);
  EXPECT_TRUE(kept["17"].valid());
  (void)registry.expect("17");
  EXPECT_FALSE(kept["17"].valid());
  int delivered = 0;
  (void)registry.claim("17", [&](FileDescriptor socket) { delivered += socket.valid() ? 1 : 0; });
  EXPECT_EQ(delivered, 1);
}

}  // namespace
}  // namespace fieldcast
