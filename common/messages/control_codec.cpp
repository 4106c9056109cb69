#include <egraph_msgs/acknowledge_t.hpp>
#include <egraph_msgs/control_reply_t.hpp>
#include <egraph_msgs/control_t.hpp>
#include <egraph_msgs/end_of_stream_t.hpp>
#include <egraph_msgs/graph_request_t.hpp>
#include <egraph_msgs/mesh_request_t.hpp>
#include <egraph_msgs/resend_request_t.hpp>

#include "common/messages/codec.hpp"
#include "common/messages/guard.hpp"
#include "common/messages/wire.hpp"
#include "common/messages/wire_geometry.hpp"

namespace eg::messages {
namespace {

base::Result<GraphRequest> decode_request(ByteView bytes) {
  const auto wire = decode_wire<egraph_msgs::graph_request_t>(bytes, {}, {});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  return checked(GraphRequest{wire->session, read_counter(wire->have_version, path("have_version"), check)}, check);
}

base::Result<MeshRequest> decode_mesh_request(ByteView bytes) {
  return decode_wire<egraph_msgs::mesh_request_t>(bytes, {}, {}).map([](const egraph_msgs::mesh_request_t& wire) {
    return MeshRequest{wire.session};
  });
}

base::Result<Acknowledge> decode_acknowledge(ByteView bytes) {
  const auto wire = decode_wire<egraph_msgs::acknowledge_t>(bytes, {}, {{"consumer", kMaxName}});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  return checked(Acknowledge{wire->session, read_counter(wire->sequence, path("sequence"), check), wire->consumer},
                 check);
}

base::Result<EndOfStream> decode_end(ByteView bytes) {
  const auto wire =
      decode_wire<egraph_msgs::end_of_stream_t>(bytes, {{"num_skipped", kMaxSkippedFrames, sizeof(std::int64_t)}}, {});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  EndOfStream end{wire->session, read_counter(wire->frame_count, path("frame_count"), check), wire->skipped_utimes};
  for (std::size_t i = 0; i < end.skipped_utimes.size(); ++i) {
    read_counter(end.skipped_utimes[i], path("skipped_utimes", i), check);
  }
  return checked(std::move(end), check);
}

base::Result<ResendRequest> decode_resend_request(ByteView bytes) {
  const auto wire = decode_wire<egraph_msgs::resend_request_t>(
      bytes, {{"num_numbers", kMaxResendNumbers, sizeof(std::int64_t)}}, {{"channel", kMaxName}});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  for (std::size_t i = 0; i < wire->numbers.size(); ++i) read_counter(wire->numbers[i], path("numbers", i), check);
  return checked(ResendRequest{wire->session, wire->channel, wire->numbers}, check);
}

base::Result<Control> decode_control(ByteView bytes) {
  const auto wire = decode_wire<egraph_msgs::control_t>(bytes, {}, {{"service", kMaxName}});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  const Command command = read_enum(wire->command, Command::shutdown, path("command"), check);
  return checked(Control{wire->request_id, command, wire->service}, check);
}

base::Result<ControlReply> decode_reply(ByteView bytes) {
  const auto wire =
      decode_wire<egraph_msgs::control_reply_t>(bytes, {}, {{"service", kMaxName}, {"message", kMaxText}});
  if (!wire) return tl::make_unexpected(wire.error());
  const Path path;
  Checker check;
  const bool ok = read_bool(wire->ok, path("ok"), check);
  return checked(ControlReply{wire->request_id, wire->service, ok, wire->message}, check);
}

}  // namespace

Bytes encode(const GraphRequest& request) {
  egraph_msgs::graph_request_t wire{};
  wire.session = request.session;
  wire.have_version = request.have_version;
  return encode_wire(wire);
}

Bytes encode(const MeshRequest& request) {
  egraph_msgs::mesh_request_t wire{};
  wire.session = request.session;
  return encode_wire(wire);
}

Bytes encode(const Acknowledge& acknowledge) {
  egraph_msgs::acknowledge_t wire{};
  wire.session = acknowledge.session;
  wire.sequence = acknowledge.sequence;
  wire.consumer = printable(acknowledge.consumer, kMaxName);
  return encode_wire(wire);
}

Bytes encode(const EndOfStream& end) {
  egraph_msgs::end_of_stream_t wire{};
  wire.session = end.session;
  wire.frame_count = end.frame_count;
  wire.num_skipped = static_cast<std::int32_t>(end.skipped_utimes.size());
  wire.skipped_utimes = end.skipped_utimes;
  return encode_wire(wire);
}

Bytes encode(const ResendRequest& request) {
  egraph_msgs::resend_request_t wire{};
  wire.session = request.session;
  wire.num_numbers = static_cast<std::int32_t>(request.numbers.size());
  wire.numbers = request.numbers;
  wire.channel = printable(request.channel, kMaxName);
  return encode_wire(wire);
}

Bytes encode(const Control& control) {
  egraph_msgs::control_t wire{};
  wire.request_id = control.request_id;
  wire.command = static_cast<std::int8_t>(control.command);
  wire.service = printable(control.service, kMaxName);
  return encode_wire(wire);
}

Bytes encode(const ControlReply& reply) {
  egraph_msgs::control_reply_t wire{};
  wire.request_id = reply.request_id;
  wire.ok = static_cast<std::int8_t>(reply.ok);
  wire.service = printable(reply.service, kMaxName);
  wire.message = printable(reply.message, kMaxText);
  return encode_wire(wire);
}

template <>
base::Result<GraphRequest> decode(ByteView bytes) {
  return guarded<GraphRequest>([&] { return decode_request(bytes); });
}

template <>
base::Result<MeshRequest> decode(ByteView bytes) {
  return guarded<MeshRequest>([&] { return decode_mesh_request(bytes); });
}

template <>
base::Result<Acknowledge> decode(ByteView bytes) {
  return guarded<Acknowledge>([&] { return decode_acknowledge(bytes); });
}

template <>
base::Result<EndOfStream> decode(ByteView bytes) {
  return guarded<EndOfStream>([&] { return decode_end(bytes); });
}

template <>
base::Result<ResendRequest> decode(ByteView bytes) {
  return guarded<ResendRequest>([&] { return decode_resend_request(bytes); });
}

template <>
base::Result<Control> decode(ByteView bytes) {
  return guarded<Control>([&] { return decode_control(bytes); });
}

template <>
base::Result<ControlReply> decode(ByteView bytes) {
  return guarded<ControlReply>([&] { return decode_reply(bytes); });
}

}  // namespace eg::messages
