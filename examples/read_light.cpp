// The solved light in C++17, without a library: what an engine would do with it.
//
//     airlight export-lattice builtin:cornell -o light -t lpv -D resolution=24
//     c++ -std=c++17 -O2 examples/read_light.cpp -o read_light
//     ./read_light light 0.5 0.01 -0.5   0 1 0
//
// You should see the indirect irradiance, W m^-2 in red, green and blue, on a surface at that
// point (metres) with that normal. It reads header.json and an array of each lattice, and looks the
// light up as an engine's shader would: trilinear between cells, half a cell before the surface.
// That is the first order; airlight's own lookup (LightField.irradiance) also keeps light from
// leaking through walls. read_light.mjs is the same in JavaScript.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

using Vec3 = std::array<double, 3>;

static double dot(const Vec3 &a, const Vec3 &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static std::string bytes_of(const std::string &path) {
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw std::runtime_error(path + ": cannot be read (export-lattice -o names a folder here)");
    return {std::istreambuf_iterator<char>(file), {}};
}

// ---- JSON, as far as the header needs it; an engine has a reader of its own ---------------------

struct Json {
    std::string text;  // of strings, numbers and the words true, false, null
    std::vector<Json> items;
    std::map<std::string, Json> keys;

    const Json &operator[](const std::string &key) const { return keys.at(key); }
    double number() const { return std::strtod(text.c_str(), nullptr); }
    Vec3 vector() const {
        return {items.at(0).number(), items.at(1).number(), items.at(2).number()};
    }
};

class JsonReader {
public:
    explicit JsonReader(std::string text) : text_(std::move(text)) {}

    Json value() {
        Json found;
        const char first = next();
        if (first == '{' || first == '[') {
            const char last = first == '{' ? '}' : ']';
            ++at_;
            while (next() != last) {
                if (text_[at_] == ',') {
                    ++at_;
                } else if (first == '[') {
                    found.items.push_back(value());
                } else {
                    const std::string key = value().text;
                    if (next() != ':') throw std::runtime_error("header.json: a ':' is missing");
                    ++at_;
                    found.keys[key] = value();
                }
            }
            ++at_;
        } else if (first == '"') {
            for (++at_; text_.at(at_) != '"'; ++at_) {
                if (text_[at_] == '\\') ++at_;  // none of the keys that are read has an escape
                found.text += text_.at(at_);
            }
            ++at_;
        } else {
            while (at_ < text_.size() && !std::strchr(",]} \n\r\t", text_[at_])) {
                found.text += text_[at_++];
            }
            if (found.text.empty()) throw std::runtime_error("header.json: a value is missing");
        }
        return found;
    }

private:
    char next() {
        while (at_ < text_.size() && std::strchr(" \n\r\t", text_[at_])) ++at_;
        return text_.at(at_);
    }

    std::string text_;
    std::size_t at_ = 0;
};

// ---- The arrays ---------------------------------------------------------------------------------

// The numbers of an .npy file of 32-bit floats in C order, on a machine of little endian.
static std::vector<float> read_npy(const std::string &path) {
    const std::string file = bytes_of(path);
    if (file.size() < 12 || file.compare(1, 5, "NUMPY") != 0) {
        throw std::runtime_error(path + ": not an .npy file");
    }
    const auto byte = [&](std::size_t k) { return std::size_t(std::uint8_t(file[k])); };
    const bool is_long = byte(6) > 1;
    std::size_t size = byte(8) | byte(9) << 8;
    if (is_long) size |= byte(10) << 16 | byte(11) << 24;
    const std::size_t begin = (is_long ? 12 : 10) + size;
    const std::string head = file.substr(0, begin);
    if (head.find("'<f4'") == head.npos || head.find("'fortran_order': False") == head.npos) {
        throw std::runtime_error(path + ": not float32 in C order");
    }
    std::vector<float> data((file.size() - begin) / sizeof(float));
    std::memcpy(data.data(), file.data() + begin, data.size() * sizeof(float));
    return data;
}

struct Lattice {
    std::array<Vec3, 3> axes;  // unit vectors of the world, along which all below lies
    Vec3 origin_m;
    double cell_m;
    std::array<int, 3> count;  // x, y, z
    std::array<Vec3, 4> fade_m;
    std::vector<float> surfaces;  // (z, y, x, rgb, 4)
};

// The lattices of a folder that `airlight export-lattice` wrote, the finest first.
static std::vector<Lattice> read_lattices(const std::string &folder) {
    const Json header = JsonReader(bytes_of(folder + "/header.json")).value();
    if (header["format"].text != "airlight light field") {
        throw std::runtime_error(folder + ": no light field");
    }
    std::vector<Lattice> lattices;
    for (const Json &about : header["lattices"].items) {
        Lattice lattice;
        for (int k = 0; k < 3; ++k) {
            lattice.axes[k] = about["axes_xyz"].items.at(k).vector();
            lattice.count[k] = int(about["count_xyz"].items.at(k).number());
        }
        for (int k = 0; k < 4; ++k) lattice.fade_m[k] = about["fade_m"].items.at(k).vector();
        lattice.origin_m = about["origin_m"].vector();
        lattice.cell_m = about["cell_m"].number();
        const std::string name = "lattice" + std::to_string(lattices.size()) + "_surfaces.npy";
        lattice.surfaces = read_npy(folder + "/" + name);
        const std::size_t cells = std::size_t(lattice.count[0]) * lattice.count[1] * lattice.count[2];
        if (lattice.surfaces.size() != 12 * cells) throw std::runtime_error(name + ": another size");
        lattices.push_back(std::move(lattice));
    }
    return lattices;
}

// ---- The lookup ---------------------------------------------------------------------------------

// How much of a lattice's light counts at a point (its own axes): 1 inside, 0 at its border.
static double weight(const Lattice &lattice, const Vec3 &p) {
    const auto &[low, low_width, high, high_width] = lattice.fade_m;
    double least = 1.0;
    for (int k = 0; k < 3; ++k) {
        least = std::min({least, (p[k] - low[k]) / low_width[k], (high[k] - p[k]) / high_width[k]});
    }
    return std::max(least, 0.0);
}

// Irradiance, W m^-2, of one lattice at a point with a normal, both in its own axes.
static Vec3 lattice_irradiance(const Lattice &lattice, const Vec3 &p, const Vec3 &n) {
    std::array<int, 3> low;
    Vec3 t;
    for (int k = 0; k < 3; ++k) {
        // Cell centres lie at whole numbers; half a cell before the surface there is no wall.
        const double before = p[k] + 0.5 * lattice.cell_m * n[k] - lattice.origin_m[k];
        const int last = lattice.count[k] - 1;
        const double at = std::clamp(before / lattice.cell_m - 0.5, 0.0, double(last));
        low[k] = std::min(int(std::floor(at)), std::max(last - 1, 0));
        t[k] = at - low[k];
    }
    Vec3 total{};
    for (int corner = 0; corner < 8; ++corner) {
        std::array<int, 3> cell;
        double share = 1.0;
        for (int k = 0; k < 3; ++k) {
            const int step = corner >> k & 1;
            cell[k] = std::min(low[k] + step, lattice.count[k] - 1);
            share *= step ? t[k] : 1.0 - t[k];
        }
        const auto [x, y, z] = cell;
        const std::size_t row = (std::size_t(z) * lattice.count[1] + y) * lattice.count[0] + x;
        for (int c = 0; c < 3; ++c) {
            // Real spherical harmonics Y00, Y1-1 (y), Y10 (z), Y11 (x) of the way the light travels.
            const float *sh = &lattice.surfaces[(row * 3 + c) * 4];
            const double a = 0.282095 * sh[0];
            const Vec3 b{0.488603 * sh[3], 0.488603 * sh[1], 0.488603 * sh[2]};
            total[c] += share * M_PI * std::max(a - 2.0 / 3.0 * dot(b, n), 0.0);
        }
    }
    return total;
}

// Irradiance, W m^-2, at a point of the world, metres, on a surface with a normal.
static Vec3 irradiance(const std::vector<Lattice> &lattices, const Vec3 &point, const Vec3 &normal) {
    Vec3 total{};
    double left = 1.0;
    for (const Lattice &lattice : lattices) {
        Vec3 p, n;
        for (int k = 0; k < 3; ++k) {
            p[k] = dot(lattice.axes[k], point);
            n[k] = dot(lattice.axes[k], normal);
        }
        const double share = left * weight(lattice, p);
        const Vec3 found = lattice_irradiance(lattice, p, n);
        for (int c = 0; c < 3; ++c) total[c] += share * found[c];
        left -= share;
    }
    return total;
}

static double number_of(const char *word) {
    char *end = nullptr;
    const double found = std::strtod(word, &end);
    if (end == word || *end) throw std::runtime_error(std::string(word) + ": not a number");
    return found;
}

int main(int count, char **words) {
    if (count != 8) {
        std::fprintf(stderr, "usage: read_light FOLDER X Y Z NX NY NZ\n");
        return 2;
    }
    try {
        std::array<double, 6> at;
        for (int k = 0; k < 6; ++k) at[k] = number_of(words[k + 2]);
        const Vec3 found =
            irradiance(read_lattices(words[1]), {at[0], at[1], at[2]}, {at[3], at[4], at[5]});
        std::printf("%.9g %.9g %.9g\n", found[0], found[1], found[2]);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return 2;
    }
}
