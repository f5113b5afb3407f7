// Writes to a store and prints what the store reported as stored. The test kills this process at
// any moment.
//
//     store_writer FILE samples BATCHES    "stored N" after each batch of 10: samples 0 to N-1
//     store_writer FILE commands COUNT     "taken N" for each command that may run
//     store_writer FILE check SAMPLES COMMANDS
//                       checks that the file is valid and has so many; prints what is missing
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <future>
#include <string>

#include "bridge/log/log.hpp"
#include "bridge/store/command_id_table.hpp"
#include "bridge/store/store.hpp"
#include "tests/bridge/store/store_support.hpp"

using namespace fieldcast;
using Verdict = CommandIdTable::Verdict;

namespace {

constexpr int kBatch = 10;

// Writes without a buffer, so that the text survives a kill.
void say(const std::string& text) {
  if (::write(STDOUT_FILENO, text.data(), text.size()) < 0) std::abort();
}

void write_samples(const StoreAddress& address, int batches) {
  Store store(test::forever(address));
  const auto intake = store.intake(test::bus_of("b", {"c"}));
  for (int number = 0; number < batches * kBatch;) {
    for (int i = 0; i < kBatch; ++i, ++number) {
      const Sample one[] = {test::sample(0, double(number), number, std::uint64_t(number) + 1)};
      intake->put(one, test::kClock, test::utc(number));
    }
    store.append({.who = "campaign", .what = "batch", .target = std::to_string(number)});
    if (!store.flush(std::chrono::seconds{30})) std::exit(3);
    say("stored " + std::to_string(store.counters().stored) + "\n");
  }
}

Verdict verdict_of(CommandIdTable& identities, int number) {
  std::promise<Verdict> verdict;
  identities.enter("campaign", static_cast<std::uint64_t>(number),
                   [&](Verdict told) { verdict.set_value(told); });
  return verdict.get_future().get();
}

void take_commands(const StoreAddress& address, int count) {
  CommandIdTable identities(address);
  for (int number = 0; number < count; ++number) {
    if (verdict_of(identities, number) == Verdict::kNew)
      say("taken " + std::to_string(number + 1) + "\n");
  }
}

int check(const StoreAddress& address, int samples, int commands) {
  const auto connection = open_store(address, IfMissing::kCreate);
  std::string whole;
  connection->query("pragma integrity_check", {}, [&](const SqlRow& row) {
    whole = std::get<std::string>(row.at(0));
    return false;
  });
  if (whole != "ok") return std::printf("the file is not whole: %s\n", whole.c_str()), 1;
  const auto history = samples > 0 ? test::history(address, "b") : std::vector<StoredSample>{};
  if (history.size() < static_cast<std::size_t>(samples))
    return std::printf("%d samples were stored, %zu are there\n", samples, history.size()), 1;
  for (int number = 0; number < samples; ++number) {
    if (std::get<double>(history[static_cast<std::size_t>(number)].value) != number)
      return std::printf("sample %d is another one\n", number), 1;
  }
  CommandIdTable identities(address);
  for (int number = 0; number < commands; ++number) {
    if (verdict_of(identities, number) != Verdict::kKnown)
      return std::printf("command %d would run again\n", number), 1;
  }
  return 0;
}

}  // namespace

int main(int count, char** words) {
  if (count < 4)
    return std::fputs("store_writer FILE samples|commands|check NUMBER..\n", stderr), 2;
  const StoreAddress address(words[1]);
  const std::string what = words[2];
  const int number = std::atoi(words[3]);
  if (what == "samples") return write_samples(address, number), 0;
  if (what == "commands") return take_commands(address, number), 0;
  return check(address, number, count > 4 ? std::atoi(words[4]) : 0);
}
