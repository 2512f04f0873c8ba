//! The mesh files that a URDF names, where they exist in a format Rerun reads.

use std::path::{Path, PathBuf};

/// The formats of [`rerun::Asset3D`].
const FORMATS: [&str; 5] = ["glb", "gltf", "obj", "stl", "dae"];

/// The file behind a URDF's mesh `name`, if it is there and Rerun can show it.
///
/// `package://<package>/<rest>` is `<package>/<rest>` in the URDF's folder or one above it, or `<rest>` in one of that
/// name; `file://<path>` and plain paths are taken from the URDF's folder. A file outside the package's folder, or outside
/// the folder that contains the URDF's folder, is refused, whether dots or links lead there, because an untrusted URDF must
/// not open private files.
pub fn resolve(name: &str, urdf_path: &Path) -> Option<PathBuf> {
    let is_shown = Path::new(name)
        .extension()
        .is_some_and(|extension| FORMATS.iter().any(|format| extension.eq_ignore_ascii_case(format)));
    if !is_shown {
        return None;
    }
    let urdf_path = std::path::absolute(urdf_path).ok()?;
    let folder = urdf_path.parent()?;
    // A file that cannot be opened counts as missing.
    let existing = |path: PathBuf, within: &Path| {
        let [target, within] = [path.as_path(), within].map(|path| path.canonicalize().ok());
        let is_within = target?.starts_with(within?);
        (is_within && path.is_file() && std::fs::File::open(&path).is_ok()).then_some(path)
    };
    let Some(in_package) = name.strip_prefix("package://") else {
        let around = folder.parent().unwrap_or(folder);
        return existing(folder.join(name.strip_prefix("file://").unwrap_or(name)), around);
    };
    let (package, rest) = in_package.split_once('/')?;
    if matches!(package, "" | "." | "..") {
        return None;
    }
    folder.ancestors().find_map(|ancestor| {
        let is_package = ancestor.file_name().is_some_and(|name| name == package);
        let below = existing(ancestor.join(in_package), &ancestor.join(package));
        below.or_else(|| is_package.then(|| existing(ancestor.join(rest), ancestor)).flatten())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_are_found_as_ros_lays_them_out() {
        let root = tempfile::tempdir().expect("a folder");
        let package = root.path().join("my_arm");
        let urdf = package.join("urdf/arm.urdf");
        for folder in ["urdf", "meshes"] {
            std::fs::create_dir_all(package.join(folder)).expect("a folder");
        }
        let mesh = package.join("meshes/base.STL");
        std::fs::write(&mesh, "solid").expect("a file");

        assert_eq!(resolve("package://my_arm/meshes/base.STL", &urdf), Some(mesh.clone()));
        assert_eq!(resolve("package://another/meshes/base.STL", &urdf), None);
        assert_eq!(resolve("../meshes/base.STL", &urdf), Some(package.join("urdf/../meshes/base.STL")));
        assert_eq!(resolve(&format!("file://{}", mesh.display()), &urdf), Some(mesh));
        assert_eq!(resolve("package://my_arm/meshes/base.step", &urdf), None);
    }

    #[test]
    fn meshes_outside_the_package_are_refused() {
        let root = tempfile::tempdir().expect("a folder");
        let urdf = root.path().join("downloads/my_arm/urdf/arm.urdf");
        let meshes = root.path().join("downloads/my_arm/meshes");
        for folder in [urdf.parent().expect("a folder"), &meshes] {
            std::fs::create_dir_all(folder).expect("a folder");
        }
        let secret = root.path().join("secret.stl");
        std::fs::write(&secret, "solid").expect("a file");
        for name in [
            "package://my_arm/../../../secret.stl",
            "package://my_arm/../../secret.stl",
            "package://../secret.stl",
            "package://../../../secret.stl",
            "package:///secret.stl",
            "../../../secret.stl",
        ] {
            assert_eq!(resolve(name, &urdf), None, "{name}");
        }
        for scheme in ["", "file://"] {
            assert_eq!(resolve(&format!("{scheme}{}", secret.display()), &urdf), None);
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&secret, meshes.join("link.stl")).expect("a link");
            assert_eq!(resolve("package://my_arm/meshes/link.stl", &urdf), None);
            assert_eq!(resolve("../meshes/link.stl", &urdf), None);
        }
    }
}
