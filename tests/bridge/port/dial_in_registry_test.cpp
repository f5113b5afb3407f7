#include "bridge/port/dial_in_registry.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace fieldcast {
namespace {

FileDescriptor some_socket() { return FileDescriptor(::socket(AF_INET, SOCK_STREAM, 0)); }

TEST(DialInRegistry, ABusThatEndsLateTakesNothingFromTheNextOne) {
  DialInRegistry registry;
  const auto first = registry.expect("17");
  int delivered = 0;
  const auto old =
      registry.claim("17", [](ModuleConnection) { ADD_FAILURE() << "to the old bus"; });
  const auto second = registry.expect("17");
  const auto claim = registry.claim("17", [&](ModuleConnection) { ++delivered; });
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
  std::vector<ModuleConnection> given;
  const auto take = [&](ModuleConnection connection) { given.push_back(std::move(connection)); };
  const auto older = registry.claim("17", take);
  EXPECT_FALSE(registry.offer("17", some_socket()));
  registry.release("17", older);

  FileDescriptor newer = some_socket();
  const int wanted = newer.get();
  EXPECT_FALSE(registry.offer("17", std::move(newer)));
  registry.pass_on("17", std::move(given.at(0)));  // its bus starts late: the newer one waits
  (void)registry.claim("17", take);
  ASSERT_EQ(given.size(), 2u);
  EXPECT_EQ(given[1].socket.get(), wanted);
}

TEST(DialInRegistry, AnOlderConnectionThatComesAfterANewerOneWasDeliveredIsClosed) {
  DialInRegistry registry;
  (void)registry.expect("17");
  std::vector<ModuleConnection> given;
  (void)registry.claim(
      "17", [&](ModuleConnection connection) { given.push_back(std::move(connection)); });
  EXPECT_FALSE(registry.offer("17", some_socket()));
  EXPECT_FALSE(registry.offer("17", some_socket()));
  ASSERT_EQ(given.size(), 2u);
  registry.pass_on("17", std::move(given[0]));
  EXPECT_EQ(given.size(), 2u);
  registry.pass_on("17", std::move(given[1]));
  EXPECT_EQ(given.size(), 3u) << "the newest one goes from bus to bus";
}

TEST(DialInRegistry, AModuleThatWaitsForABusThatEndsIsKeptAndGivenToTheNextOne) {
  DialInRegistry registry;
  std::map<std::string, ModuleConnection> kept;
  registry.set_keeper({[&](const std::string& number, ModuleConnection connection) {
                         kept[number] = std::move(connection);
                       },
                       [&](const std::string& number) {
                         const auto found = kept.find(number);
                         return found == kept.end() ? ModuleConnection{} : std::move(found->second);
                       }});
  const auto first = registry.expect("17");
  EXPECT_FALSE(registry.offer("17", some_socket()));
  registry.forget("17", first);
  EXPECT_TRUE(kept["17"].socket.valid());
  (void)registry.expect("17");
  EXPECT_FALSE(kept["17"].socket.valid());
  int delivered = 0;
  (void)registry.claim(
      "17", [&](ModuleConnection connection) { delivered += connection.socket.valid() ? 1 : 0; });
  EXPECT_EQ(delivered, 1);
}

}  // namespace
}  // namespace fieldcast
