#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/gnss_config.h"
#include "gnss/base/geodesy.h"
#include "gnss/formats/observation.h"
#include "gnss/orbits/satellite_catalog.h"

namespace alidade {

/// One satellite of an epoch, corrected: what the models of gnss/model/measurement_model.h take.
struct SatelliteMeasurement {
  SatelliteId satellite;
  SignalCode signal;                     ///< that of the pseudorange; the first of an ionosphere-free pair
  double frequency_hz = 0;               ///< of `signal`
  double pseudorange_m = 0;              ///< as measured, or the ionosphere-free combination
  std::optional<double> range_rate_mps;  ///< -lambda D, as measured
  double cn0_dbhz = 0;                   ///< 0 = not reported
  SatelliteState state;                  ///< at transmission
  double group_delay_m = 0;              ///< to be added to the predicted pseudorange
  // Known once the receiver is located:
  Direction direction;
  double ionosphere_m = 0;  ///< on this signal
  double troposphere_m = 0;
  double pseudorange_variance = 0;  ///< [m^2]
  double range_rate_variance = 0;   ///< [m^2/s^2]
  // What Locate needs:
  double ephemeris_variance = 0;  ///< [m^2] of orbit, clock and group delay
  double noise_gain = 1;          ///< of the combination on the noise of a code
  std::optional<double> reported_std_m;
  std::optional<double> reported_rate_std_mps;
  /// Pseudorange refused by the epoch's single-point solution, in favour of what most satellites agree on.
  bool contradicted = false;
};

/// Satellites of an epoch that were left out, by reason.
struct MeasurementCounts {
  int no_ephemeris = 0;
  int unhealthy = 0;
  int no_signal = 0;  ///< no pseudorange in a band that is used, or beyond bounds, or too weak
  int unused_system = 0;

  void Add(const MeasurementCounts& other);
};
/// "3 without ephemeris, 0 unhealthy, 1 without signal".
[[nodiscard]] std::string Describe(const MeasurementCounts& counts);

/// How the errors of an epoch's pseudoranges differ from white noise as stated
/// (gnss/positioning/pseudorange_errors.h).
struct PseudorangeNoise {
  double scale = 1;             ///< factor on the stated deviations, at least 1
  double lasting_variance = 0;  ///< c [m^2] of errors beside, which last
  double epochs = 1;  ///< m: the mean of all epochs so far has the lasting variance m c / k of k epochs
  double settled_epochs = 1;  ///< g = m - k dm/dk: what m is short of growing with k; 1 for a constant error

  /// What the next epoch adds to the information of k epochs, k / (w + m c), over that of one with white
  /// errors of the stated variance V: V (w + g c) / (w + m c)^2, w = scale^2 V. At most 1.
  [[nodiscard]] double InformationShare(double stated_variance) const {
    const double white = scale * scale * stated_variance;
    const double of_mean = white + epochs * lasting_variance;
    return stated_variance * (white + settled_epochs * lasting_variance) / (of_mean * of_mean);
  }
  /// For several epochs at once, none of which was used before: each has the same share.
  [[nodiscard]] PseudorangeNoise AtOnce() const { return {scale, lasting_variance, epochs, epochs}; }
};

/// The measurements of one epoch.
struct EpochMeasurements {
  TimeNs tag_ns = 0;                             ///< receiver's time tag, GPST
  std::vector<SatelliteMeasurement> satellites;  ///< sorted by satellite
  MeasurementCounts left_out;
  PseudorangeNoise noise = {};  ///< measured
};

/// Turns observations into corrected measurements. One call of Prepare an epoch computes orbits and clocks,
/// whatever the number of iterations that follow.
class MeasurementBuilder {
 public:
  MeasurementBuilder(std::shared_ptr<const SatelliteCatalog> catalog, GnssCorrectionOptions options,
                     std::map<int, int> glonass_channels = {});

  /// Chooses a signal a satellite and computes satellite state and group delay. Independent of the receiver.
  [[nodiscard]] EpochMeasurements Prepare(const ObservationEpoch& epoch) const;

  /// Fills direction, atmosphere and variances for a receiver at `position_E` (metres are enough).
  void Locate(const Eigen::Vector3d& position_E, EpochMeasurements* epoch) const;

  [[nodiscard]] const GnssCorrectionOptions& options() const { return options_; }

 private:
  /// The signals a satellite's measurement is made of; `second` for an ionosphere-free pair alone.
  struct SignalChoice {
    const SignalObservation* first = nullptr;
    const SignalObservation* second = nullptr;
    double f1 = 0;
    double f2 = 0;
    bool usable = false;
  };
  [[nodiscard]] SignalChoice Choose(const SatelliteObservation& observed) const;
  [[nodiscard]] double IonosphereL1(const GeodeticPosition& receiver, const Direction& direction,
                                    TimeNs stamp_ns) const;
  [[nodiscard]] std::optional<double> Frequency(SatelliteId satellite, char band) const;
  [[nodiscard]] std::optional<SatelliteMeasurement> PrepareSatellite(TimeNs tag_ns,
                                                                     const SatelliteObservation& observed,
                                                                     MeasurementCounts* left_out) const;

  std::shared_ptr<const SatelliteCatalog> catalog_;
  GnssCorrectionOptions options_;
  std::map<int, int> glonass_channels_;
};

/// Variance of a code or Doppler measurement whose deviation at the zenith and 45 dB-Hz is `zenith_std`:
///   std^2 = zenith_std^2 (1 + 1/sin^2(el)) / 2 * 10^((45 - C/N0) / 10),
/// the last factor kept within 1/2 and 1000 and left out where C/N0 is not reported. A reported deviation
/// takes the place of zenith_std and C/N0. Sources: elevation as in RTKLIB's manual, E.6.1; C/N0 as in
/// Hartinger and Brunner, "Variances of GPS phase observations: the SIGMA-epsilon model", 1999.
[[nodiscard]] double ObservationVariance(double zenith_std, double elevation_rad, double cn0_dbhz,
                                         std::optional<double> reported_std);

}  // namespace alidade
