// The bridge's side of ConfigurationRequest and ConfigurationReply. Owns one reader and one writer.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "bridge/dds/endpoints/part_pace.hpp"
#include "bridge/dds/receivers/request_receiver.hpp"
#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/topics/configuration_message.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

class ConfigurationEndpoint {
 public:
  // Requests that are received at the same time, each from a writer of its own.
  static constexpr std::size_t kMaxIncomplete = 4;

  // A complete request for this bridge, on a DDS thread.
  using Received = std::function<void(ConfigurationMessage request, const RequestOrigin& origin)>;
  // Throws DdsError, for example if this member has no right to the topic.
  ConfigurationEndpoint(Domain& domain, const std::string& bridge, const std::string& label,
                        Instant now, Received received);
  ConfigurationEndpoint(const ConfigurationEndpoint&) = delete;
  ConfigurationEndpoint& operator=(const ConfigurationEndpoint&) = delete;

  // Waits between parts; returns early, without the rest, when close() is called. One thread at a
  // time.
  void respond(const ConfigurationMessage& reply);
  void close();  // any thread; nothing is received after it returns

 private:
  struct Incomplete {
    std::uint64_t request_id = 0;
    ConfigurationParts parts;
  };
  void take(const idl::ConfigurationRequest& part, const dds::SampleInfo& info);

  Domain& domain_;
  const std::string bridge_;
  const Instant listening_;
  const Received received_;
  std::map<rtps::GUID_t, Incomplete> incomplete_;  // by writer; used by the reader's thread
  Taker<idl::ConfigurationRequest> taker_;
  dds::DataWriter* writer_ = nullptr;
  dds::DataReader* reader_ = nullptr;
  PartPace pace_;
};

}  // namespace fieldcast
