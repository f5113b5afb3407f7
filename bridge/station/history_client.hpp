// A station's side of HistoryRequest and HistoryBlock: one request at a time. Its endpoints exist
// only while they are used, because every reader receives the responses to all stations.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/topics/history.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/station/station.hpp"

namespace fieldcast {

class HistoryClient {
 public:
  // `requester` must be unique in the domain.
  HistoryClient(Domain& domain, std::string requester);
  ~HistoryClient() { end(); }
  HistoryClient(const HistoryClient&) = delete;
  HistoryClient& operator=(const HistoryClient&) = delete;

  // Station::history(). One thread at a time.
  [[nodiscard]] tl::expected<HistoryResponse, StationFault> request(HistoryRequest request,
                                                                    Duration wait);
  // Removes the endpoints. The thread of request().
  void end();

 private:
  // Each reports whether a bridge has the other endpoint. Called on DDS threads.
  struct WriterMatches : dds::DataWriterListener {
    explicit WriterMatches(HistoryClient& owner) : client(owner) {}
    void on_publication_matched(dds::DataWriter*,
                                const dds::PublicationMatchedStatus& status) override {
      client.set(client.is_writer_matched_, status.current_count > 0);
    }
    HistoryClient& client;
  };
  struct ReaderMatches : Taker<idl::HistoryBlock> {
    explicit ReaderMatches(HistoryClient& owner)
        : Taker([&owner](const idl::HistoryBlock& block, const auto&) { owner.take(block); }),
          client(owner) {}
    void on_subscription_matched(dds::DataReader*,
                                 const dds::SubscriptionMatchedStatus& status) override {
      client.set(client.is_reader_matched_, status.current_count > 0);
    }
    HistoryClient& client;
  };

  [[nodiscard]] bool begin();
  void set(bool& is_matched, bool value);
  void take(const idl::HistoryBlock& block);

  Domain& domain_;
  const std::string requester_;
  std::uint64_t next_id_ = 1;
  dds::DataWriter* writer_ = nullptr;
  dds::DataReader* reader_ = nullptr;

  std::mutex mutex_;  // protects the members below
  std::condition_variable changed_;
  std::uint64_t id_ = 0;  // of the pending request; 0: none
  std::optional<HistoryParts> parts_;
  std::optional<HistoryResponse> response_;
  bool is_writer_matched_ = false, is_reader_matched_ = false;

  WriterMatches writer_matches_{*this};
  ReaderMatches reader_matches_{*this};
};

}  // namespace fieldcast
