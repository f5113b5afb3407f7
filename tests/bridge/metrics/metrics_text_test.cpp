#include "bridge/metrics/metrics_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "bridge/metrics/metrics_snapshot.hpp"

namespace fieldcast {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::Each;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

// All numbers differ, so that a swapped one is detected.
BusFigures press_shop() {
  BusFigures bus;
  bus.bus = "press-shop";
  bus.at = UtcTime{1'700'000'000'500'000'000};
  bus.report.state = BusState::kRunning;
  bus.report.utilisation = 0.75;
  bus.report.planned_load = 0.5;
  bus.report.measured_load = 0.625;
  bus.report.stretch = 1.25;
  bus.report.silence = std::chrono::milliseconds{2};
  bus.report.exchanges = 11;
  bus.report.samples = 12;
  bus.report.commands = 13;
  bus.report.deadline_misses = 14;
  bus.report.bytes_sent = 15;
  bus.report.bytes_received = 16;
  bus.report.reopened = 17;
  bus.report.causes.add(Cause::kChecksum, 18);
  bus.report.misses.add(Cause::kLate, 19);
  bus.dds = {.deadline_misses = 20,
             .sample_readers = 21,
             .sample_writers = 22,
             .blocks = 23,
             .block_readers = 24};
  return bus;
}

DeviceFigures press() {
  DeviceFigures device{"press-shop", "press-1", {}};
  device.report.state = DeviceState::kDegraded;
  device.report.exchanges = 31;
  device.report.failures = 32;
  device.report.retries = 33;
  device.report.deadline_misses = 34;
  device.report.response_time = milliseconds{2};
  device.report.response_spread = microseconds{250};
  device.report.timeout = milliseconds{200};
  device.report.pause = milliseconds{5};
  device.report.refused = {"holding:1", "holding:2"};
  device.report.refused_gaps = {"holding:5..7"};
  device.report.causes.add(Cause::kNoResponse, 35);
  device.report.areas.push_back({"holding", milliseconds{3}, microseconds{100}, 36, 37});
  return device;
}

MetricsSnapshot snapshot() {
  MetricsTable table;
  table.note(press_shop());
  table.note(press());
  table.note(GatewayFigures{"press-shop", {51, 52, 53, 54}});
  MetricsSnapshot made{.bridge = "line-7"};
  table.copy_to(made);
  made.store = StoreCounters{.stored = 41, .dropped = 42, .waiting = 43, .quarantined = 44};
  made.receive_buffer = 1 << 20;
  made.refused_datagrams[static_cast<std::size_t>(RtpsFault::kGap)] = 44;
  return made;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> samples_of(const std::string& text) {
  std::vector<std::string> lines = lines_of(text);
  std::erase_if(lines, [](const std::string& line) { return line.starts_with('#'); });
  return lines;
}

TEST(MetricsText, HasEveryFigureOfABus) {
  const auto samples = samples_of(metrics_text(snapshot(), MetricsFormat::kOpenMetrics));
  for (const char* line : {
           R"(fieldcast_bridge_info{bridge="line-7"} 1)",
           R"(fieldcast_bus_state{bus="press-shop",state="running"} 1)",
           R"(fieldcast_bus_state{bus="press-shop",state="opening"} 0)",
           R"(fieldcast_bus_report_timestamp_seconds{bus="press-shop"} 1700000000.5)",
           R"(fieldcast_bus_utilisation_ratio{bus="press-shop"} 0.75)",
           R"(fieldcast_bus_planned_load_ratio{bus="press-shop"} 0.5)",
           R"(fieldcast_bus_measured_load_ratio{bus="press-shop"} 0.625)",
           R"(fieldcast_bus_stretch_ratio{bus="press-shop"} 1.25)",
           R"(fieldcast_bus_silence_seconds{bus="press-shop"} 0.002)",
           R"(fieldcast_bus_exchanges_total{bus="press-shop"} 11)",
           R"(fieldcast_bus_samples_total{bus="press-shop"} 12)",
           R"(fieldcast_bus_commands_total{bus="press-shop"} 13)",
           R"(fieldcast_bus_deadline_misses_total{bus="press-shop"} 14)",
           R"(fieldcast_bus_sent_bytes_total{bus="press-shop"} 15)",
           R"(fieldcast_bus_received_bytes_total{bus="press-shop"} 16)",
           R"(fieldcast_bus_reopenings_total{bus="press-shop"} 17)",
           R"(fieldcast_bus_failed_exchanges_total{bus="press-shop",cause="CHECKSUM"} 18)",
           R"(fieldcast_bus_missed_refreshes_total{bus="press-shop",cause="LATE"} 19)",
           R"(fieldcast_dds_deadline_misses_total{bus="press-shop"} 20)",
           R"(fieldcast_dds_sample_readers{bus="press-shop"} 21)",
           R"(fieldcast_dds_sample_writers{bus="press-shop"} 22)",
           R"(fieldcast_dds_blocks_total{bus="press-shop"} 23)",
           R"(fieldcast_dds_block_readers{bus="press-shop"} 24)",
           R"(fieldcast_gateway_clients{bus="press-shop"} 51)",
           R"(fieldcast_gateway_refused_clients_total{bus="press-shop"} 52)",
           R"(fieldcast_gateway_requests_total{bus="press-shop"} 53)",
           R"(fieldcast_gateway_refused_requests_total{bus="press-shop"} 54)",
           R"(fieldcast_dds_receive_buffer_bytes 1048576)",
           R"(fieldcast_dds_refused_datagrams_total{cause="GAP"} 44)",
       })
    EXPECT_THAT(samples, testing::Contains(line));
  EXPECT_THAT(samples, Each(Not(HasSubstr("fieldcast_bus_closed"))));
}

TEST(MetricsText, HasEveryFigureOfADeviceAndItsAreas) {
  const auto samples = samples_of(metrics_text(snapshot(), MetricsFormat::kOpenMetrics));
  const std::string labels = R"({bus="press-shop",device="press-1"})";
  const std::string failed = R"({bus="press-shop",device="press-1",cause="NO_ANSWER"})";
  const std::string area = R"({bus="press-shop",device="press-1",area="holding"})";
  for (const std::string& line : {
           std::string(
               R"(fieldcast_device_state{bus="press-shop",device="press-1",state="degraded"} 1)"),
           "fieldcast_device_exchanges_total" + labels + " 31",
           "fieldcast_device_failures_total" + labels + " 32",
           "fieldcast_device_retries_total" + labels + " 33",
           "fieldcast_device_deadline_misses_total" + labels + " 34",
           "fieldcast_device_answer_seconds" + labels + " 0.002",
           "fieldcast_device_answer_spread_seconds" + labels + " 0.00025",
           "fieldcast_device_timeout_seconds" + labels + " 0.2",
           "fieldcast_device_pause_seconds" + labels + " 0.005",
           "fieldcast_device_refused_addresses" + labels + " 2",
           "fieldcast_device_refused_gaps" + labels + " 1",
           "fieldcast_device_failed_exchanges_total" + failed + " 35",
           "fieldcast_device_area_answer_seconds" + area + " 0.003",
           "fieldcast_device_area_answer_spread_seconds" + area + " 0.0001",
           "fieldcast_device_area_largest_block" + area + " 36",
           "fieldcast_device_area_longest_block" + area + " 37",
       })
    EXPECT_THAT(samples, testing::Contains(line));
}

TEST(MetricsText, HasTheStoreOnlyWhereThereIsOne) {
  auto with = snapshot();
  EXPECT_THAT(metrics_text(with, MetricsFormat::kOpenMetrics),
              testing::AllOf(HasSubstr("\nfieldcast_store_samples_total 41\n"),
                             HasSubstr("\nfieldcast_store_dropped_samples_total 42\n"),
                             HasSubstr("\nfieldcast_store_quarantined_rows_total 44\n"),
                             HasSubstr("\nfieldcast_store_waiting_samples 43\n")));
  with.alarms = AlarmCounts{5, 4, 3, 2, 1, 6};
  EXPECT_THAT(metrics_text(with, MetricsFormat::kOpenMetrics),
              testing::AllOf(HasSubstr("\nfieldcast_alarms{state=\"unacknowledged\"} 5\n"),
                             HasSubstr("\nfieldcast_alarms{state=\"suppressed\"} 1\n"),
                             HasSubstr("\nfieldcast_chattering_alarms 6\n")));
  with.store.reset();
  EXPECT_THAT(metrics_text(with, MetricsFormat::kOpenMetrics), Not(HasSubstr("_store_")));
}

TEST(MetricsText, AClosedBusSaysWhy) {
  BusFigures bus = press_shop();
  bus.report.state = BusState::kClosed;
  bus.report.closed_because = Cause::kPortMissing;
  MetricsSnapshot made{.bridge = "b"};
  made.buses.push_back(std::make_shared<const BusFigures>(bus));
  EXPECT_THAT(metrics_text(made, MetricsFormat::kOpenMetrics),
              HasSubstr(R"(fieldcast_bus_closed{bus="press-shop",cause="PORT_MISSING"} 1)"));
}

// OpenMetrics 1.0: a family is described once, before its samples, which are contiguous.
TEST(MetricsText, DescribesEveryFamilyOnceBeforeItsSamples) {
  for (const auto format : {MetricsFormat::kOpenMetrics, MetricsFormat::kPrometheus}) {
    std::set<std::string> described;
    std::string name, type;
    for (const std::string& line : lines_of(metrics_text(snapshot(), format))) {
      std::istringstream words(line);
      std::string mark, keyword, family;
      words >> mark >> keyword >> family;
      if (mark == "#" && keyword == "HELP") {
        EXPECT_TRUE(described.insert(family).second) << line;
        name = family;
      } else if (mark == "#" && keyword == "TYPE") {
        EXPECT_EQ(family, name);
        words >> type;
      } else if (mark == "#" && keyword == "UNIT") {
        std::string unit;
        words >> unit;
        EXPECT_THAT(family, EndsWith('_' + unit));
      } else if (mark != "#") {
        const bool total = type == "counter" && format == MetricsFormat::kOpenMetrics;
        EXPECT_EQ(mark.substr(0, mark.find('{')), name + (total ? "_total" : "")) << line;
      }
    }
    EXPECT_GT(described.size(), 35u);
  }
}

TEST(MetricsText, EndsAsItsFormatSays) {
  EXPECT_THAT(metrics_text(snapshot(), MetricsFormat::kOpenMetrics), EndsWith("\n# EOF\n"));
  const std::string older = metrics_text(snapshot(), MetricsFormat::kPrometheus);
  EXPECT_THAT(older, Not(HasSubstr("EOF")));
  EXPECT_THAT(older, Not(HasSubstr("# UNIT")));
  EXPECT_THAT(older, HasSubstr("# TYPE fieldcast_bus_samples_total counter\n"));
}

TEST(MetricsText, TheFormatIsTheOneThatTheClientAccepts) {
  EXPECT_EQ(format_for("application/openmetrics-text;version=1.0.0,text/plain;q=0.5"),
            MetricsFormat::kOpenMetrics);
  EXPECT_EQ(format_for("text/plain"), MetricsFormat::kPrometheus);
  EXPECT_EQ(format_for(""), MetricsFormat::kPrometheus);
}

TEST(MetricsText, LabelsAreEscaped) {
  EXPECT_EQ(escaped_label("a\"b\\c\nx"), R"(a\"b\\c\nx)");
  EXPECT_EQ(escaped_label("°C"), "°C");
}

TEST(MetricsTable, KeepsTheLastReportAndForgetsABus) {
  MetricsTable table;
  table.note(press_shop());
  table.note(press());
  BusFigures newer = press_shop();
  newer.report.samples = 99;
  table.note(newer);
  MetricsSnapshot before;
  table.copy_to(before);
  ASSERT_THAT(before.buses, SizeIs(1));
  EXPECT_EQ(before.buses[0]->report.samples, 99u);
  table.remove("press-shop");
  MetricsSnapshot after;
  table.copy_to(after);
  EXPECT_THAT(after.buses, IsEmpty());
  EXPECT_THAT(after.devices, IsEmpty());
  EXPECT_EQ(before.devices[0]->report.exchanges, 31u) << "a snapshot goes on";
}

}  // namespace
}  // namespace fieldcast
