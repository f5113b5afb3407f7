// The state of a DdsLink: dds_link.cpp joins, adds and removes; dds_link_publish.cpp publishes.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <shared_mutex>
#include <string>
#include <typeindex>
#include <utility>
#include <vector>

#include "bridge/dds/endpoints/block_bursts.hpp"
#include "bridge/dds/endpoints/block_writer.hpp"
#include "bridge/dds/endpoints/bridge_announcement.hpp"
#include "bridge/dds/endpoints/bus_catalogue.hpp"
#include "bridge/dds/endpoints/configuration_endpoint.hpp"
#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/dds/endpoints/history_endpoint.hpp"
#include "bridge/dds/endpoints/result_sender.hpp"
#include "bridge/dds/endpoints/sample_writers.hpp"
#include "bridge/dds/receivers/interest_receiver.hpp"
#include "bridge/dds/receivers/request_receiver.hpp"

namespace fieldcast {

// The entities of one bus, except the writers that all buses share.
struct LinkedBus {
  LinkedBus(Domain& domain, const std::string& bridge, const BusSpec& spec,
            dds::DataWriter* catalogue_blocks, const BlockWriter::Stream& stream,
            SnapshotSender& snapshots);

  void note_refreshes();

  const BusSpec spec;  // first: the catalogue refers to it
  BusCatalogue catalogue;
  BlockWriter blocks;  // keeps the last values for blocks and single samples
  SampleWriters samples;
  std::map<std::string, idl::DeviceStatus> devices;                 // published at least once
  std::map<std::pair<ChannelIndex, LimitKind>, idl::Alarm> alarms;  // raised at least once
  std::map<AlarmKey, idl::AlarmStatus> alarm_status;                // published at least once
  idl::BusStatus status;
  std::vector<idl::ReadPlan> plan;  // its parts, as published
  std::vector<idl::DeviceDescription> descriptions;
  std::atomic<bool> may_wait = false;  // its refreshes allow its blocks to wait for a burst
  bool reported = false;
  bool write_failed = false;
};

// One writer for each Report of topics.hpp, which all buses share. Those of the periodic ones are
// renewed.
class ReportWriters {
 public:
  ReportWriters(Domain& domain, const std::string& label,
                const std::function<void(const std::string&)>& on_problem) {
    for_each_report([&]<class Generated>(const Report<Generated>& topic) {
      const auto make = [&domain, &topic, label](auto* listener, dds::StatusMask mask) {
        return domain.writer(topic, label, listener, mask);
      };
      try {
        writers_.emplace(std::piecewise_construct,
                         std::tuple(std::type_index(typeid(typename Generated::type))),
                         std::forward_as_tuple(domain, make));
      } catch (const DdsError& error) {
        if (!topic.is_optional) throw;
        on_problem(std::string(error.what()) +
                   ": goes on without it; 'fieldcast secure renew' gives an identity of an earlier "
                   "version this right");
      }
    });
  }
  // Without effect on an optional topic that cannot be written.
  template <class Message>
  void write(Message& message) {
    const auto found = writers_.find(typeid(Message));
    if (found != writers_.end()) found->second.write(&message);
  }
  template <class Message>
  void unregister(Message& message) {
    const auto found = writers_.find(typeid(Message));
    if (found != writers_.end()) found->second.unregister(&message);
  }
  // Each instance of these topics is written again within the overlap.
  void tidy(Instant now) {
    writers_.at(typeid(idl::BusStatus)).tidy(now);
    writers_.at(typeid(idl::DeviceStatus)).tidy(now);
  }

 private:
  std::map<std::type_index, RenewedWriter> writers_;
};

struct DdsLink::State {
  using Commands = RequestReceiver<idl::Command, State>;
  using Actions = RequestReceiver<idl::AlarmAction, State>;
  // Receivers of requests: of unrestricted senders, or of members restricted to one bus.
  struct Receivers {
    std::unique_ptr<Commands> commands;
    std::unique_ptr<Actions> actions;  // null if alarm actions are not wanted

    void close() const;
  };

  State(const DdsSpec& spec, const std::string& name, Handlers given);

  // Runs on the snapshot thread: writes changed catalogue entries, then the last values.
  SnapshotSender::Sent send_snapshot(const std::string& name, SnapshotSender::Part part);

  template <class Message>
  void receive(const Message& message, const RequestOrigin& origin);
  Receivers listen(const HeldTo& bus);
  // Responds to requests that are not forwarded: malformed ones and expired alarm actions.
  template <class Message>
  void reject(const Message& message, const std::string& subject, const MalformedCommand& why);

  // Writes the blocks that wait, in as few datagrams as their size allows.
  void write_burst();

  // Returns null if there is no such bus. REQUIRES: mutex held, shared or exclusive.
  LinkedBus* find(std::string_view name);
  void dispose(LinkedBus& bus, Duration linger, Duration limit = kInfinite);
  // Call it after dispose(): readers may receive the end of a writer before its last blocks,
  // because the library receives it on another thread; the end of the catalogue follows the blocks.
  void wait_for_block_readers(Duration linger);
  // Returns the prepared bus, or creates it.
  std::unique_ptr<LinkedBus> made(const BusSpec& spec);
  void serve(const std::string& name, std::unique_ptr<LinkedBus> bus);
  void listen_for(const std::string& bus);
  void listen_for_history();
  void listen_for_configuration();

  const std::string bridge;
  const Handlers handlers;
  RequestWriters writers;
  Domain domain;
  const std::size_t block_bytes;
  const std::string label;
  ResultSender results;
  dds::DataWriter* const catalogue_blocks;
  ReportWriters reports;
  std::unique_ptr<InterestReceiver> interests;
  Receivers receivers;  // set by listen_for_commands()
  // Receivers for members restricted to a bus, by bus.
  std::map<std::string, Receivers, std::less<>> held;
  std::unique_ptr<BridgeAnnouncement> presence;
  std::unique_ptr<HistoryEndpoint> history;  // null if it is not wanted, or without the right
  std::unique_ptr<ConfigurationEndpoint> configuration;  // as `history`
  std::shared_mutex mutex;  // shared to use a bus, exclusive to add or remove one
  std::map<std::string, std::unique_ptr<LinkedBus>, std::less<>> buses;
  std::map<std::string, std::unique_ptr<LinkedBus>, std::less<>> prepared;
  std::atomic<bool> standing_by = false;
  // The buses whose requests are received: DDS threads look them up while they hold locks of the
  // library, for which a holder of `mutex` may wait. No function is called while `names_mutex` is
  // held.
  std::mutex names_mutex;
  std::set<std::string, std::less<>> names;
  bool closed = false;
  // Last members: their threads use the buses.
  std::unique_ptr<SnapshotSender> snapshots;
  BlockBursts bursts{[this] { write_burst(); }};
};

}  // namespace fieldcast
