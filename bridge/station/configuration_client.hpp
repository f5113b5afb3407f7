// A station's side of ConfigurationRequest and ConfigurationReply: one request at a time. Its
// endpoints exist only while they are used, because every reader receives the replies to all
// stations.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/topics/configuration_message.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/station/station.hpp"

namespace fieldcast {

class ConfigurationClient {
 public:
  // `requester` must be unique in the domain.
  ConfigurationClient(Domain& domain, std::string requester);
  ~ConfigurationClient() { end(); }
  ConfigurationClient(const ConfigurationClient&) = delete;
  ConfigurationClient& operator=(const ConfigurationClient&) = delete;

  // Station::configuration(). One thread at a time.
  [[nodiscard]] tl::expected<std::string, StationFault> request(const std::string& bridge,
                                                                std::string text, Duration wait);
  // Ends a pending request and refuses later ones. Any thread.
  void cancel();

 private:
  static constexpr Duration kSettle = std::chrono::milliseconds{500};  // of new endpoints
  static constexpr Duration kLook = std::chrono::milliseconds{10};     // for a bridge
  static constexpr Duration kPace = std::chrono::microseconds{500};    // after each part

  [[nodiscard]] bool begin();
  void end();
  [[nodiscard]] bool is_matched() const;
  [[nodiscard]] bool is_cancelled();
  void take(const idl::ConfigurationReply& part);

  Domain& domain_;
  const std::string requester_;
  std::uint64_t next_id_;
  dds::DataWriter* writer_ = nullptr;
  dds::DataReader* reader_ = nullptr;

  std::mutex mutex_;  // protects the members below
  std::condition_variable changed_;
  bool is_cancelled_ = false;
  std::uint64_t id_ = 0;  // of the pending request; 0: none
  ConfigurationParts parts_;
  std::optional<std::string> reply_;

  Taker<idl::ConfigurationReply> taker_;
};

}  // namespace fieldcast
