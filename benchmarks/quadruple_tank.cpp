// The yardstick: quadruple tank, two sampled PI loops with back-calculation, one RK4 step a
// sample, written by hand for speed.
//
// Everything that depends on parameters alone is computed before the time loop, the time step is
// multiplied into it, and the levels enter only through their roots:
//     dh1 = q1 + d1 sqrt(h3) - c1 sqrt(h1),   dh3 = q3 - c3 sqrt(h3), ...
// so that a sample is 16 square roots and little else. Several vectors go side by side, because
// one vector alone would wait for its own roots.

#include <cmath>
#include <cstddef>

#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace {

#if defined(__AVX512F__)
constexpr int vector_bytes = 64;
#elif defined(__AVX__)
constexpr int vector_bytes = 32;
#else
constexpr int vector_bytes = 16;
#endif
constexpr int vector_lanes = vector_bytes / 8;

typedef double Vector __attribute__((vector_size(vector_bytes)));
typedef double UnalignedVector __attribute__((vector_size(vector_bytes), aligned(8), may_alias));

// The lower tanks wait for the roots of the upper ones.
constexpr int upper_first[4] = {2, 3, 0, 1};

constexpr double time_step = 1.0;
constexpr double gravity = 9.81;
constexpr double sensor_gain = 50.0;
constexpr double low_limit = 0.0;
constexpr double high_limit = 10.0;
constexpr double initial_integral = 3.0;

// Rows of the parameter table.
enum Parameter {
    tank_area = 0,
    outlet_area = 4,
    pump_gain = 8,
    split = 10,
    proportional_gain = 12,
    integral_time = 14,
    tracking_time = 16
};

inline Vector broadcast(double value) { return value - Vector{}; }

inline Vector root(Vector x) {
#if defined(__AVX512F__)
    return _mm512_sqrt_pd(x);
#elif defined(__AVX__)
    return _mm256_sqrt_pd(x);
#else
    Vector result;
    for (int lane = 0; lane < vector_lanes; ++lane) result[lane] = __builtin_sqrt(x[lane]);
    return result;
#endif
}

inline Vector larger(Vector a, Vector b) {
#if defined(__AVX512F__)
    return _mm512_max_pd(a, b);
#elif defined(__AVX__)
    return _mm256_max_pd(a, b);
#else
    return a > b ? a : b;
#endif
}

inline Vector smaller(Vector a, Vector b) {
#if defined(__AVX512F__)
    return _mm512_min_pd(a, b);
#elif defined(__AVX__)
    return _mm256_min_pd(a, b);
#else
    return a < b ? a : b;
#endif
}

inline Vector magnitude(Vector x) {
#if defined(__AVX512F__)
    return _mm512_abs_pd(x);
#else
    return larger(x, -x);
#endif
}

inline double root(double x) { return __builtin_sqrt(x); }
inline double larger(double a, double b) { return a > b ? a : b; }
inline double smaller(double a, double b) { return a < b ? a : b; }
inline double magnitude(double x) { return __builtin_fabs(x); }

// `count` vectors side by side, for the batch.
template <int count>
struct Lanes {
    Vector part[count];

    Lanes() = default;
    Lanes(double value) {
        for (auto &p : part) p = broadcast(value);
    }
    static constexpr int width = count * vector_lanes;
    static Lanes load(const double *from) {
        Lanes result;
        for (int i = 0; i < count; ++i)
            result.part[i] = *reinterpret_cast<const UnalignedVector *>(from + i * vector_lanes);
        return result;
    }
    void store(double *to) const {
        for (int i = 0; i < count; ++i)
            *reinterpret_cast<UnalignedVector *>(to + i * vector_lanes) = part[i];
    }
    template <class Operation>
    static inline Lanes each(Operation operation) {
        Lanes result;
#pragma GCC unroll 8
        for (int i = 0; i < count; ++i) result.part[i] = operation(i);
        return result;
    }
    friend inline Lanes operator+(const Lanes &a, const Lanes &b) {
        return each([&](int i) { return a.part[i] + b.part[i]; });
    }
    friend inline Lanes operator-(const Lanes &a, const Lanes &b) {
        return each([&](int i) { return a.part[i] - b.part[i]; });
    }
    friend inline Lanes operator*(const Lanes &a, const Lanes &b) {
        return each([&](int i) { return a.part[i] * b.part[i]; });
    }
    friend inline Lanes operator/(const Lanes &a, const Lanes &b) {
        return each([&](int i) { return a.part[i] / b.part[i]; });
    }
    friend inline Lanes root(const Lanes &a) {
        return each([&](int i) { return root(a.part[i]); });
    }
    friend inline Lanes larger(const Lanes &a, const Lanes &b) {
        return each([&](int i) { return larger(a.part[i], b.part[i]); });
    }
    friend inline Lanes smaller(const Lanes &a, const Lanes &b) {
        return each([&](int i) { return smaller(a.part[i], b.part[i]); });
    }
    friend inline Lanes magnitude(const Lanes &a) {
        return each([&](int i) { return magnitude(a.part[i]); });
    }
};

// One scenario alone has the same interface as a vector of them.
struct Single {
    static constexpr int width = 1;
    static double load(const double *from) { return *from; }
    static void store(double value, double *to) { *to = value; }
};

template <class Number, class Loader>
struct Loop {
    Number outflow[4], half_outflow[4], sixth_outflow[4];  // dt a / A sqrt(2 g)
    Number upper[2], half_upper[2], sixth_upper[2];        // what an upper tank gives to a lower
    Number inflow[4];  // dt gamma k / A, of the pump that fills the tank
    Number gain[2], integral_gain[2], tracking_gain[2];
    Number level[4], integral[2], absolute_error[2];
    Number voltage[2];

    Loop(const double *parameters, std::size_t stride, const double *initial_levels) {
        auto read = [&](int row) { return Loader::load(parameters + row * stride); };
        Number reciprocal_area[4];
        const Number fall(time_step * std::sqrt(2.0 * gravity));
        for (int tank = 0; tank < 4; ++tank) {
            reciprocal_area[tank] = Number(1.0) / read(tank_area + tank);
            outflow[tank] = fall * read(outlet_area + tank) * reciprocal_area[tank];
            half_outflow[tank] = Number(0.5) * outflow[tank];
            sixth_outflow[tank] = Number(1.0 / 6.0) * outflow[tank];
            level[tank] = Number(initial_levels[tank]);
        }
        for (int loop = 0; loop < 2; ++loop) {
            upper[loop] = fall * read(outlet_area + 2 + loop) * reciprocal_area[loop];
            half_upper[loop] = Number(0.5) * upper[loop];
            sixth_upper[loop] = Number(1.0 / 6.0) * upper[loop];
            const Number flow = Number(time_step) * read(pump_gain + loop);
            const Number share = read(split + loop);
            inflow[loop] = share * flow * reciprocal_area[loop];
            inflow[3 - loop] = (Number(1.0) - share) * flow * reciprocal_area[3 - loop];
            gain[loop] = read(proportional_gain + loop);
            integral_gain[loop] = Number(time_step) * gain[loop] / read(integral_time + loop);
            tracking_gain[loop] = Number(time_step) / read(tracking_time + loop);
            integral[loop] = Number(initial_integral);
            absolute_error[loop] = Number(0.0);
        }
    }

    inline void control(const double *setpoint) {
#pragma GCC unroll 2
        for (int loop = 0; loop < 2; ++loop) {
            const Number error = Number(setpoint[loop]) - Number(sensor_gain) * level[loop];
            const Number unlimited = gain[loop] * error + integral[loop];
            voltage[loop] =
                smaller(larger(unlimited, Number(low_limit)), Number(high_limit));
            absolute_error[loop] = absolute_error[loop] + Number(time_step) * magnitude(error);
            integral[loop] = integral[loop] + integral_gain[loop] * error +
                             tracking_gain[loop] * (voltage[loop] - unlimited);
        }
    }

    // The slopes are linear in the roots, so every stage goes straight from roots to levels and
    // only the roots are summed: the shortest chain from one stage to the next.
    inline void drop(const Number (&from)[4], const Number (&roots)[4], const Number (&out)[4],
                     const Number (&up)[2], Number (&to)[4]) const {
#pragma GCC unroll 2
        for (int loop = 0; loop < 2; ++loop) {
            to[loop] = from[loop] + up[loop] * roots[2 + loop] - out[loop] * roots[loop];
            to[2 + loop] = from[2 + loop] - out[2 + loop] * roots[2 + loop];
        }
    }

    inline void integrate() {
        const Number zero(0.0), half(0.5), two(2.0);
        Number full[4], halfway[4], at[4], roots[4], sum[4];
#pragma GCC unroll 4
        for (const int tank : upper_first) {
            const Number filled = inflow[tank] * voltage[tank < 2 ? tank : 3 - tank];
            full[tank] = level[tank] + filled;
            halfway[tank] = level[tank] + half * filled;
            roots[tank] = root(larger(level[tank], zero));
            sum[tank] = roots[tank];
        }
        drop(halfway, roots, half_outflow, half_upper, at);
#pragma GCC unroll 4
        for (const int tank : upper_first) {
            roots[tank] = root(larger(at[tank], zero));
            sum[tank] = sum[tank] + two * roots[tank];
        }
        drop(halfway, roots, half_outflow, half_upper, at);
#pragma GCC unroll 4
        for (const int tank : upper_first) {
            roots[tank] = root(larger(at[tank], zero));
            sum[tank] = sum[tank] + two * roots[tank];
        }
        drop(full, roots, outflow, upper, at);
#pragma GCC unroll 4
        for (const int tank : upper_first) sum[tank] = sum[tank] + root(larger(at[tank], zero));
        drop(full, sum, sixth_outflow, sixth_upper, level);
    }
};

template <int count>
void run_batch(const double *parameters, const double *setpoints, const double *initial_levels,
               std::size_t scenarios, std::size_t samples, std::size_t first, std::size_t last,
               double *final) {
    using Number = Lanes<count>;
    for (std::size_t lane = first; lane < last; lane += Number::width) {
        Loop<Number, Number> loop(parameters + lane, scenarios, initial_levels);
        for (std::size_t sample = 0; sample < samples; ++sample) {
            loop.control(setpoints + 2 * sample);
            loop.integrate();
        }
        double *to = final + lane;
        for (int tank = 0; tank < 4; ++tank) loop.level[tank].store(to + tank * scenarios);
        for (int i = 0; i < 2; ++i) {
            loop.integral[i].store(to + (4 + i) * scenarios);
            loop.absolute_error[i].store(to + (6 + i) * scenarios);
        }
    }
}

}  // namespace

extern "C" {

// Scenarios that go side by side with `count` vectors; ranges are multiples of it.
int lanes(int count) { return count * vector_lanes; }

// Scenarios first … last-1 of a batch; parameters [18][scenarios], setpoints [samples][2],
// final [8][scenarios]. Returns 0, or 1 where `count` is none of 1, 2, 3, 4.
int batch(int count, const double *parameters, const double *setpoints,
          const double *initial_levels, std::size_t scenarios, std::size_t samples,
          std::size_t first, std::size_t last, double *final) {
    switch (count) {
#define WITH(n)                                                                               \
    case n:                                                                                   \
        run_batch<n>(parameters, setpoints, initial_levels, scenarios, samples, first, last,  \
                     final);                                                                  \
        return 0;
        WITH(1)
        WITH(2)
        WITH(3)
        WITH(4)
#undef WITH
    }
    return 1;
}

// One run; recorded [samples][6] holds the levels and voltages of every sample.
void single(const double *parameters, const double *setpoints, const double *initial_levels,
            std::size_t samples, double *recorded, double *final) {
    Loop<double, Single> loop(parameters, 1, initial_levels);
    for (std::size_t sample = 0; sample < samples; ++sample) {
        const double start[4] = {loop.level[0], loop.level[1], loop.level[2], loop.level[3]};
        loop.control(setpoints + 2 * sample);
        double *row = recorded + 6 * sample;
        for (int tank = 0; tank < 4; ++tank) row[tank] = start[tank];
        row[4] = loop.voltage[0];
        row[5] = loop.voltage[1];
        loop.integrate();
    }
    for (int tank = 0; tank < 4; ++tank) final[tank] = loop.level[tank];
    for (int i = 0; i < 2; ++i) {
        final[4 + i] = loop.integral[i];
        final[6 + i] = loop.absolute_error[i];
    }
}

// As many roots as `steps` scenario-steps need and nothing else, in chains that do not wait for
// each other: no program that takes hardware roots can be faster than this.
void roots_alone(std::size_t steps, double *values) {
    constexpr int chains = 8;
    constexpr std::size_t roots_a_step = 16;
    Lanes<chains> chain = Lanes<chains>::load(values);
    for (std::size_t done = 0; done < steps * roots_a_step; done += Lanes<chains>::width)
        chain = root(chain) + Lanes<chains>(0.1);
    chain.store(values);
}

}  // extern "C"
