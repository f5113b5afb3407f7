// One participant in a DDS domain, with the transports, names and topics of Fieldcast. Owns every
// entity that is created through it. Any thread creates and removes endpoints.
#pragma once

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bridge/dds/filter/incoming_filter.hpp"
#include "bridge/dds/library/fastdds.hpp"
#include "bridge/dds/topics/topic_type.hpp"
#include "bridge/dds/topics/topics.hpp"
#include "bridge/dds/transport/member_watch.hpp"
#include "bridge/security/member_folder.hpp"
#include "core/model/dds_spec.hpp"

namespace fieldcast {

// Addresses that DDS uses: those of the configuration, and the loopback for peers on this machine.
[[nodiscard]] std::vector<std::string> used_interfaces(const DdsSpec& spec);

class Domain {
 public:
  // `name` is the participant name that others see. `listener` receives only discovery, must
  // outlive the domain and may be null. Throws DdsError for an address of no interface here, an
  // unreadable profile, a discovery server that is not host:port, or invalid files of the member.
  Domain(const DdsSpec& spec, const std::string& name, DiscoveryListener* listener);
  ~Domain();  // leaves the domain
  Domain(const Domain&) = delete;
  Domain& operator=(const Domain&) = delete;

  // Create endpoints; `label`: user data. The listener outlives them or is null. Throw DdsError.
  template <class Generated, class Type = TopicType<Generated>>
  dds::DataWriter* writer(const Topic<Generated>& topic, const std::string& label,
                          dds::DataWriterListener* listener = nullptr,
                          dds::StatusMask mask = dds::StatusMask::none()) {
    return writer<Generated, Type>(topic, writer_qos(topic), label, listener, mask);
  }
  template <class Generated, class Type = TopicType<Generated>>
  dds::DataReader* reader(const Topic<Generated>& topic, dds::DataReaderListener* listener,
                          dds::StatusMask mask) {
    return reader<Generated, Type>(topic, reader_qos(topic), listener, mask);
  }
  template <class Generated, class Type = TopicType<Generated>>
  dds::DataWriter* writer(const Topic<Generated>& topic, const dds::DataWriterQos& qos,
                          const std::string& label, dds::DataWriterListener* listener = nullptr,
                          dds::StatusMask mask = dds::StatusMask::none()) {
    return make_writer(make_topic(topic, dds::TypeSupport(new Type())), qos, label, listener, mask);
  }
  template <class Generated, class Type = TopicType<Generated>>
  dds::DataReader* reader(const Topic<Generated>& topic, const dds::DataReaderQos& qos,
                          dds::DataReaderListener* listener, dds::StatusMask mask) {
    return make_reader(make_topic(topic, dds::TypeSupport(new Type())), qos, listener, mask);
  }
  // A reader for members that are restricted to this bus, by DDS Security. REQUIRES: member().
  template <class Generated, class Type = TopicType<Generated>>
  dds::DataReader* reader_of_bus(const std::string& bus, const Topic<Generated>& topic,
                                 dds::DataReaderListener* listener, dds::StatusMask mask) {
    return make_reader_of_bus(bus, make_topic(topic, dds::TypeSupport(new Type())),
                              reader_qos(topic), listener, mask);
  }
  // The DDS Security identity of this participant; `std::nullopt` without DDS Security.
  [[nodiscard]] const std::optional<security::Member>& member() const { return member_; }

  // Returns true if a new participant would use a renewed certificate.
  [[nodiscard]] bool has_new_identity() const { return watch_ && watch_->has_new_identity(); }
  // The configured discovery servers that do not respond. Any thread.
  [[nodiscard]] std::vector<std::string> missing_servers() const { return servers_.missing(); }

  // Number of bridges that were found but have not shown a writer yet. Any thread.
  [[nodiscard]] std::size_t unknown_bridges() const { return servers_.unknown_bridges(); }

  // The listener of the endpoint is not called after these return.
  void remove(dds::DataWriter* writer);
  void remove(dds::DataReader* reader);

 private:
  dds::Topic* make_topic(const TopicRow& row, const dds::TypeSupport& type);
  dds::DataWriter* make_writer(dds::Topic* topic, dds::DataWriterQos qos, const std::string& label,
                               dds::DataWriterListener* listener, dds::StatusMask mask);
  dds::DataReader* make_reader_of_bus(const std::string& bus, dds::Topic* topic,
                                      const dds::DataReaderQos& qos,
                                      dds::DataReaderListener* listener, dds::StatusMask mask);
  // Throws DdsError if this member has no right to create the endpoint.
  void check_right(const dds::Topic& topic, bool writes) const;
  dds::DataReader* make_reader(dds::Topic* topic, const dds::DataReaderQos& qos,
                               dds::DataReaderListener* listener, dds::StatusMask mask);

  struct Leave {
    void operator()(dds::DomainParticipant* participant) const;  // deletes every entity first
  };
  std::optional<security::Member> member_;
  std::shared_ptr<IncomingFilter> filter_;  // null without DDS Security
  ServerWatch servers_;                     // before the participant, which calls it
  const bool has_max_rate_;
  std::unique_ptr<dds::DomainParticipant, Leave> participant_;
  dds::Publisher* publisher_ = nullptr;
  dds::Publisher* held_publisher_ = nullptr;  // for topics by bus, for a member restricted to buses
  dds::Subscriber* subscriber_ = nullptr;
  std::mutex mutex_;                                       // protects the two maps below
  std::map<dds::DataReader*, dds::Subscriber*> of_buses_;  // readers with a subscriber of their own
  std::map<std::string, dds::Topic*> topics_;
  std::unique_ptr<MemberWatch> watch_;  // null without DDS Security
};

}  // namespace fieldcast
