// A station that prints each bridge that it discovers, for busy_discovery.py. A line is an event,
// the participant's identity and the time of the monotonic clock in seconds:
//
//   joined  -   this participant is in the domain
//   reader  ID  a reader of commands matched: commands reach this bridge
//   writer  ID  a writer of results matched
//   heard   ID  the first status of a bus arrived: the bridge discovered this station too
//
//   discovery-probe DOMAIN   until its standard input ends
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <set>
#include <string>

#include "bridge/dds/topics/topics.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {
namespace {

constexpr unsigned kLongestLife = 900;  // seconds: the starter may have been killed

class Probe : dds::DataWriterListener, dds::DataReaderListener {
 public:
  explicit Probe(std::uint32_t domain) : domain_(loopback(domain), "discovery-probe", nullptr) {
    print("joined", "-");
    domain_.reader(kCommandResultTopic, this, dds::StatusMask::subscription_matched());
    domain_.reader(kBusStatusTopic, this, dds::StatusMask::data_available());
    domain_.writer(kCommandTopic, "discovery-probe", this, dds::StatusMask::publication_matched());
  }

 private:
  static DdsSpec loopback(std::uint32_t number) {
    DdsSpec spec;
    spec.domain = number;
    spec.interfaces = {"127.0.0.1"};
    return spec;
  }
  static std::string identity(const rtps::InstanceHandle_t& endpoint) {
    std::string text;
    char digits[3];
    for (int i = 0; i < 12; ++i) {
      std::snprintf(digits, sizeof digits, "%02x", endpoint.value[i]);
      text += digits;
    }
    return text;
  }
  static void print(const char* event, const std::string& participant) {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    std::printf("%s %s %.6f\n", event, participant.c_str(),
                std::chrono::duration<double>(now).count());
    std::fflush(stdout);
  }

  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override {
    if (status.current_count_change > 0) print("reader", identity(status.last_subscription_handle));
  }
  void on_subscription_matched(dds::DataReader*,
                               const dds::SubscriptionMatchedStatus& status) override {
    if (status.current_count_change > 0) print("writer", identity(status.last_publication_handle));
  }
  void on_data_available(dds::DataReader* reader) override {
    const std::lock_guard lock(mutex_);
    idl::BusStatus status;
    dds::SampleInfo info;
    while (reader->take_next_sample(&status, &info) == ReturnCode_t::RETCODE_OK) {
      const std::string from = identity(info.publication_handle);
      if (heard_.insert(from).second) print("heard", from);
    }
  }

  std::mutex mutex_;
  std::set<std::string> heard_;
  Domain domain_;
};

}  // namespace
}  // namespace fieldcast

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  alarm(fieldcast::kLongestLife);
  const fieldcast::Probe probe(static_cast<std::uint32_t>(std::atoi(argv[1])));
  char byte = 0;
  while (read(STDIN_FILENO, &byte, 1) > 0) {}
  return 0;
}
