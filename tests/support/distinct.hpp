// Messages whose every field has a value of its own, so that no two fields can be swapped unseen.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "messages/channels.hpp"

namespace gyrotwin {

/// Hands out values, each different from all before it in every type.
class Distinct {
 public:
  template <class... Fields>
  void operator()(Fields&... fields) {
    (set(fields), ...);
  }

 private:
  template <class Field>
  void set(Field& field) {
    if constexpr (std::is_array_v<Field>) {
      for (auto& element : field) set(element);
    } else if constexpr (std::is_same_v<Field, double>) {
      field = 0.0625 + static_cast<double>(++n_);
    } else if constexpr (std::is_same_v<Field, std::int64_t>) {
      field = 0x0102030405060000 + ++n_;
    } else if constexpr (std::is_same_v<Field, std::int32_t>) {
      field = 0x01020000 + static_cast<std::int32_t>(++n_);
    } else {
      field = static_cast<Field>(++n_);
    }
  }

  std::int64_t n_ = 0;
};

inline void fill(header_t& m, Distinct& set) {
  set(m.rig_id, m.source, m.epoch, m.sequence, m.tick, m.sim_time_ns, m.sender_mono_ns);
}

inline void fill(state_t& m, Distinct& set) {
  fill(m.header, set);
  set(m.mode, m.valid, m.tilt_rad, m.tilt_rate_rad_s, m.disc_tilt_rad, m.disc_tilt_rate_rad_s,
      m.disc_angle_rad, m.disc_rate_rad_s, m.gimbal_angle_rad, m.gimbal_rate_rad_s,
      m.rotor_speed_rad_s, m.drive_torque_nm, m.mac);
}

inline void fill(command_t& m, Distinct& set) {
  fill(m.header, set);
  set(m.mode, m.valid_ticks, m.value, m.for_tick, m.owner_epoch, m.writer, m.counter, m.mac);
}

inline void fill(request_t& m, Distinct& set) {
  fill(m.header, set);
  set(m.verb, m.kind, m.initial_given, m.target, m.initial_q, m.initial_v, m.speed_factor,
      m.step_ticks, m.id, m.start_tick, m.duration_ns, m.rise_ns, m.seed, m.force_n, m.moment_nm,
      m.frequency_hz, m.speed_m_s, m.direction_rad, m.turbulence_m_s, m.length_m, m.correlation_s,
      m.yaw_rate_rad_s, m.deceleration_m_s2, m.mass_kg, m.position_m, m.level, m.delay_ns,
      m.owner_epoch, m.writer, m.counter, m.mac);
}

inline void fill(reply_t& m, Distinct& set) {
  fill(m.header, set);
  set(m.request_writer, m.request_counter, m.verb, m.result, m.applied_tick, m.id, m.text, m.mac);
}

inline void fill(truth_t& m, Distinct& set) {
  fill(m.header, set);
  set(m.q, m.v, m.contact_lower_n, m.contact_upper_n, m.holding_moment_nm, m.kinetic_energy_j,
      m.potential_energy_j, m.angular_momentum_nms, m.external_force_n, m.external_moment_nm,
      m.ground_acceleration_m_s2, m.yaw_rate_rad_s, m.added_mass_kg, m.load_cell_n,
      m.tilt_margin_rad, m.gimbal_margin_rad, m.drive_margin_nm, m.mac);
}

inline void fill(status_t& m, Distinct& set) {
  fill(m.header, set);
  set(m.service, m.mode, m.clock, m.disturbances, m.faults, m.pid, m.host, m.text, m.speed_factor,
      m.tick_period_ns, m.overruns, m.skipped_ticks, m.rhs_evaluations_max, m.lateness_p50_ns,
      m.lateness_p99_ns, m.lateness_max_ns, m.compute_p50_ns, m.compute_p99_ns, m.compute_max_ns,
      m.command_writer, m.command_counter, m.request_writer, m.request_counter,
      m.refused_not_finite, m.refused_epoch, m.refused_expired, m.refused_counter, m.refused_writer,
      m.malformed, m.foreign, m.other_rig, m.unauthentic, m.kernel_dropped, m.send_failed, m.sent,
      m.received, m.gaps, m.repeats, m.reordered, m.mac);
}

inline void fill(sensors_t& m, Distinct& set) {
  fill(m.header, set);
  set(m.valid, m.estop, m.gyro_rad_s, m.acceleration_m_s2, m.disc_angle_rad, m.gimbal_angle_rad,
      m.rotor_speed_rad_s, m.drive_current_a, m.bus_voltage_v, m.load_cell_n, m.mac);
}

inline void fill(beat_t& m, Distinct& set) {
  fill(m.header, set);
  set(m.mode, m.rotors, m.command_timeout_ticks, m.safe_stop, m.safe_stop_gain, m.sent_ns,
      m.echo_ns, m.heard_ns, m.frames_received, m.frames_bad, m.frames_dropped, m.commands_obeyed,
      m.safe_stops, m.mac);
}

inline void fill(link_t& m, Distinct& set) {
  fill(m.header, set);
  set(m.connected, m.device_mode, m.device_epoch, m.round_trip_p50_ns, m.round_trip_max_ns,
      m.clock_offset_ns, m.clock_offset_sigma_ns, m.clock_drift_ppm, m.reconnects, m.host_received,
      m.host_bad, m.host_dropped, m.device_received, m.device_bad, m.device_dropped,
      m.samples_missed, m.commands_obeyed, m.safe_stops, m.text, m.mac);
}

inline void fill(health_t& m, Distinct& set) {
  fill(m.header, set);
  set(m.verdict, m.blame, m.blamed_index, m.sensor_verdict, m.innovation, m.nis, m.nis_limit,
      m.nis_total, m.external_moment_nm, m.external_moment_sigma_nm, m.disc_friction_nm,
      m.disc_friction_sigma_nm, m.gyro_bias_rad_s, m.accelerometer_bias_m_s2, m.step_p50_ns,
      m.step_max_ns, m.text, m.mac);
}

inline void fill(forecast_t& m, Distinct& set) {
  fill(m.header, set);
  set(m.outcome, m.law, m.horizon_ns, m.falls_in_ns, m.peak_tilt_rad, m.peak_in_ns,
      m.final_tilt_rad, m.tilt_margin_rad, m.gimbal_margin_rad, m.saturates_in_ns,
      m.fall_probability, m.age_ns, m.mac);
}

/// A message with distinct fields.
template <class Message>
Message distinct() {
  Message message{};
  Distinct set;
  fill(message, set);
  return message;
}

/// The payload of a message.
template <class Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// Payload of the distinct message of a channel's type, with this rig id in its header.
inline std::vector<std::uint8_t> distinct_payload(Channel channel, std::int32_t rig_id) {
  const auto payload = [rig_id](auto message) {
    message.header.rig_id = rig_id;
    return encoded(message);
  };
  switch (channel) {
    case Channel::kState:
    case Channel::kTwinState:
      return payload(distinct<state_t>());
    case Channel::kCommand:
      return payload(distinct<command_t>());
    case Channel::kRequest:
      return payload(distinct<request_t>());
    case Channel::kReply:
      return payload(distinct<reply_t>());
    case Channel::kTruth:
      return payload(distinct<truth_t>());
    case Channel::kIntegratorStatus:
    case Channel::kControllerStatus:
    case Channel::kHardwareStatus:
    case Channel::kMirrorStatus:
    case Channel::kGatewayStatus:
      return payload(distinct<status_t>());
    case Channel::kSensors:
      return payload(distinct<sensors_t>());
    case Channel::kLink:
      return payload(distinct<link_t>());
    case Channel::kHealth:
      return payload(distinct<health_t>());
    case Channel::kForecast:
      return payload(distinct<forecast_t>());
  }
  return {};
}

}  // namespace gyrotwin
