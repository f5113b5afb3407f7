// A station's side of commands: writes Command and AlarmAction, and matches CommandResult to them.
// A thread sends a command that was_not_run() again under a new request_id; the caller sees one
// command, one request_id and one result. Any thread.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/station/bus_servers.hpp"
#include "bridge/station/station.hpp"

namespace fieldcast {

// The names of a station, and the ids of its commands and actions at all its sites. Any thread.
struct StationIdentity {
  explicit StationIdentity(const std::string& station);

  const std::string name;
  const std::string short_name;  // at most 128 bytes
  const std::string requester;   // ends with ":pid:random"; unique for each object
  const std::string of_persons;  // prefix of the requesters of users
  std::atomic<std::uint64_t> next_id{1};

 private:
  StationIdentity(const std::string& station, const std::string& suffix);
};

class CommandClient {
 public:
  // `station` must outlive it.
  CommandClient(Domain& domain, StationIdentity& station);
  ~CommandClient();

  void on_result(std::function<void(const StationResult&)> handler);
  [[nodiscard]] tl::expected<std::uint64_t, StationFault> send(StationCommand command,
                                                               Duration wait_for_bridge,
                                                               bool awaited);
  [[nodiscard]] tl::expected<std::uint64_t, StationFault> send(AlarmAction action,
                                                               Duration wait_for_bridge,
                                                               bool awaited);
  // Waits for the result of a message that was sent with `awaited`.
  [[nodiscard]] StationOutcome await(std::uint64_t request_id, Duration wait);

 private:
  // Per command, with growing pauses from kTry, as a bridge that releases a bus may still be found.
  static constexpr int kMostAttempts = 6;
  // Commands that are stored until their result is received. Further commands have one attempt.
  static constexpr std::size_t kMaxKept = 1024;
  // Period of retries of a command that waits for another bridge.
  static constexpr Duration kTry = std::chrono::milliseconds{50};

  // A bridge that does not accept commands within this time after it claimed a bus no longer delays
  // commands for another bridge: a claim can be forged.
  static constexpr Duration kLongestMatch = std::chrono::seconds{2};

  // Distinct lifespans, each with a writer. Beyond that, the nearest shorter one is used.
  static constexpr std::size_t kMaxLifespans = 16;
  static constexpr Duration kActionLifespan = std::chrono::seconds{5};

  // A writer, and the bridges whose readers have matched.
  struct Matches : dds::DataWriterListener {
    void on_publication_matched(dds::DataWriter*,
                                const dds::PublicationMatchedStatus& status) override;

    CommandClient* client = nullptr;
    dds::DataWriter* entity = nullptr;
    std::set<dds::InstanceHandle_t> readers;
    std::atomic<bool> found_new{true};
    const std::chrono::steady_clock::time_point made = std::chrono::steady_clock::now();
  };
  template <class Message>
  struct Writer : Matches {
    // The first message to a new bridge is sent alone: of more than 256 messages before its reader
    // discovers this writer, Fast DDS 2.9.1 loses the excess and reports it as acknowledged.
    [[nodiscard]] bool write(Message& message) {
      const std::lock_guard lock(writing);
      if (!once.write(message)) {
        once.make_room(std::chrono::seconds{1});
        if (!once.write(message)) return false;
      }
      if (found_new.exchange(false)) entity->wait_for_acknowledgments({1, 0});
      return true;
    }

    OnceWriter<Message> once;
    std::mutex writing;
  };
  using CommandWriter = Writer<idl::Command>;
  using ActionWriter = Writer<idl::AlarmAction>;
  struct ResultListener : dds::DataReaderListener {
    void on_data_available(dds::DataReader* reader) override;
    void on_subscription_matched(dds::DataReader*,
                                 const dds::SubscriptionMatchedStatus& status) override;
    CommandClient* client = nullptr;
  };

  // A command that was sent and can be sent again.
  struct Kept {
    StationCommand command;
    std::uint64_t first_id = 0;  // the caller's
    std::chrono::steady_clock::time_point ends;
    int attempts = 1;
    std::chrono::steady_clock::time_point next;
    StationResult refusal;  // of the last attempt
  };

  // LIFESPAN is a QoS of a writer, so each lifespan has a writer.
  CommandWriter& writer_for(Duration lifespan);
  ActionWriter& action_writer();
  // True for requesters of this process or of a user who sends through it.
  [[nodiscard]] bool is_ours(std::string_view requester) const;
  // True if each bridge that accepts commands for the bus has matched this writer and the reader of
  // results, except bridges that have had kLongestMatch for it. REQUIRES: mutex_ held.
  [[nodiscard]] bool reaches(const std::string& bus, const Matches& writer) const;
  // Waits for the bridge of the bus, then writes. Returns the request_id, which is set here unless
  // it was reserved. `note(id)` is called before the message is written, with mutex_ held.
  template <class Message, class Note>
  [[nodiscard]] tl::expected<std::uint64_t, StationFault> write(Message& message,
                                                                Writer<Message>& writer,
                                                                Duration wait_for_bridge,
                                                                Note note);
  [[nodiscard]] tl::expected<std::uint64_t, StationFault> send(Kept kept, Duration wait_for_bridge,
                                                               bool awaited);
  // REQUIRES: mutex_ held.
  void keep(std::uint64_t request_id, Kept kept);
  void on_result(StationResult result);
  void deliver(const StationResult& result);
  // The thread that sends commands again, until closing_.
  void send_again();

  Domain& domain_;
  StationIdentity& station_;
  std::mutex mutex_;  // protects everything below except the entities themselves
  std::condition_variable changed_;
  std::mutex making_;  // one thread creates writers
  std::map<Duration, std::unique_ptr<CommandWriter>> writers_;
  std::unique_ptr<ActionWriter> actions_;
  ResultListener listener_;
  dds::DataReader* results_ = nullptr;
  std::set<dds::InstanceHandle_t> result_writers_;
  std::map<std::uint64_t, std::optional<StationResult>> awaited_;
  std::function<void(const StationResult&)> handler_;
  std::map<std::uint64_t, Kept> kept_;  // by the request_id of the last attempt
  std::vector<Kept> again_;             // those that wait for a bridge
  bool closing_ = false;
  std::thread resender_;
  BusServers servers_;  // last member: it calls the members above
};

}  // namespace fieldcast
