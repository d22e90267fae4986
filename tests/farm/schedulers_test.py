# SPDX-License-Identifier: Apache-2.0
"""Tests of schedulers that work over a network: their manifests and definitions, and the commands in them."""
import copy
import json
import re
import subprocess
import sys
import xml.etree.ElementTree as xml

from harness import FARM, SAMPLES, Films, needs


class Kubernetes(Films):
    def manifest(self, name):
        import yaml
        return yaml.safe_load((FARM / "kubernetes" / name).read_text())

    @needs("kubernetes_validate", "kubernetes-validate")
    def test_manifests_are_those_of_kubernetes(self):
        import kubernetes_validate
        for name in "render.yaml", "merge.yaml":
            kubernetes_validate.validate(self.manifest(name), "1.33", strict=True)
        # The validator detects errors.
        broken = self.manifest("render.yaml")
        broken["spec"]["completionsMode"] = "Indexed"
        with self.assertRaises(Exception):
            kubernetes_validate.validate(broken, "1.33", strict=True)

    @needs("yaml", "PyYAML")
    def test_pods_render_the_picture(self):
        render = self.manifest("render.yaml")["spec"]
        container = render["template"]["spec"]["containers"][0]
        self.assertEqual(render["template"]["spec"]["restartPolicy"], "Never", "a policy for failures needs that")
        self.assertNotIn("command", container, "the image's program gets the signals itself")
        for index in range(render["completions"]):
            # The kubelet inserts variables into arguments in this way.
            words = [word.replace("$(JOB_COMPLETION_INDEX)", str(index)) for word in container["args"]]
            words = [word.replace("/films", str(self.films)).replace("=4096", f"={4 * SAMPLES}") for word in words]
            if index >= 4:
                continue
            self.run_it("fathom", *[re.sub(r"\+1/16", "+1/4", word).replace(str(4 * SAMPLES), str(SAMPLES)) for word in words])
        merge = self.manifest("merge.yaml")["spec"]["template"]["spec"]["containers"][0]
        self.assertEqual(merge["command"], ["/bin/sh", "-c"])
        self.run_shell(merge["args"][0].replace("/films", str(self.films)))
        self.check_picture()
        counts = {word.split("/")[1] for word in container["args"] if word.startswith("--part=")}
        self.assertEqual(counts, {str(render["completions"])}, "as many parts as pods")

    @needs("yaml", "PyYAML")
    def test_what_becomes_of_failures(self):
        spec = self.manifest("render.yaml")["spec"]
        rules = {tuple(rule["onExitCodes"]["values"]): rule["action"] for rule in spec["podFailurePolicy"]["rules"] if "onExitCodes" in rule}
        self.assertEqual(rules, {(130,): "Ignore", (2,): "FailJob"})
        self.assertGreaterEqual(spec["template"]["spec"]["terminationGracePeriodSeconds"], 60)
        security = spec["template"]["spec"]["securityContext"]
        self.assertTrue(security["runAsNonRoot"] and security["runAsUser"] > 0)


class AwsBatch(Films):
    def document(self, name):
        return json.loads((FARM / "aws-batch" / name).read_text())

    @needs("botocore", "botocore")
    def test_requests_are_those_of_the_service(self):
        import botocore.session
        import botocore.validate
        service = botocore.session.get_session().get_service_model("batch")

        def errors(operation, request):
            shape = service.operation_model(operation).input_shape
            return botocore.validate.ParamValidator().validate(request, shape).generate_report()
        for operation, names in (("RegisterJobDefinition", ["render-definition.json", "merge-definition.json"]),
                                 ("SubmitJob", ["render-job.json", "merge-job.json"])):
            for name in names:
                self.assertEqual(errors(operation, self.document(name)), "", name)
        broken = copy.deepcopy(self.document("render-definition.json"))
        broken["retryStrategy"]["attempts"] = "10"
        self.assertNotEqual(errors("RegisterJobDefinition", broken), "")

    def command(self, name, parameters):
        """Returns the command of a job definition, with a job's parameters inserted."""
        definition = self.document(name)
        known = {**definition["parameters"], **parameters}
        return [known[word[5:]] if word.startswith("Ref::") else word.replace("/films", str(self.films))
                for word in definition["containerProperties"]["command"]]

    def test_jobs_render_the_picture(self):
        parameters = {"scene": str(self.films / "scene.json"), "samples": str(SAMPLES), "parts": "3"}
        for index in range(3):
            self.run_it(*self.command("render-definition.json", parameters), AWS_BATCH_JOB_ARRAY_INDEX=str(index))
        self.run_it(*self.command("merge-definition.json", {"picture": str(self.films / "picture.exr")}))
        self.check_picture()
        job = self.document("render-job.json")
        self.assertEqual(str(job["arrayProperties"]["size"]), job["parameters"]["parts"], "as many parts as jobs")
        self.assertEqual(job["jobDefinition"], self.document("render-definition.json")["jobDefinitionName"])

    def test_what_becomes_of_failures(self):
        retry = self.document("render-definition.json")["retryStrategy"]
        actions = {rule["onExitCode"]: rule["action"] for rule in retry["evaluateOnExit"] if "onExitCode" in rule}
        self.assertEqual(actions, {"130": "RETRY", "137": "RETRY", "2": "EXIT", "1": "EXIT"})
        self.assertLessEqual(len(retry["evaluateOnExit"]), 5, "the service takes no more")


class OpenCue(Films):
    def job(self, *more):
        result = self.run_it(sys.executable, FARM / "opencue" / "submit.py", "scene.json", ".", "--parts", "3", "--spp", str(SAMPLES), "--print", *more)
        return xml.fromstring(result.stdout)

    def test_frames_render_the_picture(self):
        layers = {layer.get("name"): layer for layer in self.job().iter("layer")}
        self.assertEqual(layers["render"].find("range").text, "1-3")
        for frame in 1, 2, 3:
            self.run_shell(layers["render"].find("cmd").text.replace("#IFRAME#", str(frame)))
        self.run_shell(layers["merge"].find("cmd").text)
        self.check_picture()

    def test_names_with_blanks_stay_whole(self):
        (self.films / "a b;c.json").write_bytes(self.scene_text)
        result = self.run_it(sys.executable, FARM / "opencue" / "submit.py", "a b;c.json", ".", "--parts", "2", "--spp", str(SAMPLES), "--print")
        job = xml.fromstring(result.stdout)
        for frame in 1, 2:
            self.run_shell(next(job.iter("layer")).find("cmd").text.replace("#IFRAME#", str(frame)))
        self.assertTrue((self.films / "part-2.exr").exists())
        self.assertRegex(job.find("job").get("name"), r"^[\w-]+$")

    @needs("outline", "opencue-pyoutline")
    def test_the_job_has_the_form_of_opencues_own(self):
        """The job has the elements, in the order, that OpenCue's own package writes for such a job."""
        import outline
        import outline.cuerun
        import outline.modules.shell
        from outline.backend import cue
        job = outline.Outline("fathom-scene", show="testing", frame_range="1-3")
        parts = outline.modules.shell.Shell("render", command=["a"], range="1-3")
        picture = outline.modules.shell.Shell("merge", command=["b"], range="1")
        picture.depend_all(parts)
        for layer in parts, picture:
            layer.set_arg("memory", "4g")
        job.add_layer(parts), job.add_layer(picture)
        theirs = xml.fromstring(cue.serialize(outline.cuerun.OutlineLauncher(job)))

        def tree(element, known):
            return (element.tag, sorted(element.attrib), [tree(e, known) for e in element if known is None or e.tag in known])
        ours = self.job()
        tags = {element.tag for element in ours.iter()}
        self.assertEqual(tree(ours, None), tree(theirs, tags))


if __name__ == "__main__":
    subprocess.sys.exit("run by farm_test.py")
